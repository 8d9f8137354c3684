#include "tubebin/evaluation/micro_recall.hpp"

#include <gmock/gmock.h>

#include "tubebin/core/error.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::evaluation {
namespace {

using ::testing::ElementsAre;

void append(std::vector<SegmentId>& truth, std::vector<SegmentId>& predicted, SegmentId t, SegmentId p, int count) {
  truth.insert(truth.end(), static_cast<std::size_t>(count), t);
  predicted.insert(predicted.end(), static_cast<std::size_t>(count), p);
}

/// Equation 1 point by point, over every way to match truth ids with predicted ids.
double micro_recall_by_definition(const std::vector<SegmentId>& truth, const std::vector<SegmentId>& predicted,
                                  std::vector<SegmentId> truth_ids, std::vector<SegmentId> predicted_ids) {
  constexpr SegmentId nothing = 9999;
  while (predicted_ids.size() < truth_ids.size() + 8) predicted_ids.push_back(nothing);
  std::sort(predicted_ids.begin(), predicted_ids.end());
  double best = 0.0;
  do {
    int correct = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      for (std::size_t k = 0; k < truth_ids.size(); ++k)
        correct += truth[i] == truth_ids[k] && predicted[i] == predicted_ids[k];
    best = std::max(best, static_cast<double>(correct) / static_cast<double>(truth.size()));
  } while (std::next_permutation(predicted_ids.begin(), predicted_ids.end()));
  return best;
}

/// Section 5, Figures 4 and 5: two tubes, three label colours and the null colour, 72 points. Figure 5's
/// numbers leave open whether the last two belong to the third tube or to the null colour; Equation 1 gives
/// 50/72 for both.
TEST(MicroRecall, PaperExample) {
  for (const SegmentId third : {SegmentId{3}, kNullId}) {
    std::vector<SegmentId> truth, predicted;
    append(truth, predicted, 1, 1, 26);
    append(truth, predicted, 1, 2, 2);
    append(truth, predicted, 1, third, 11);
    append(truth, predicted, 2, 1, 2);
    append(truth, predicted, 2, 2, 24);
    append(truth, predicted, 2, third, 7);
    const Matching matching = match_segments(count_pairs(truth, predicted));
    EXPECT_EQ(matching.correct, 50);
    EXPECT_EQ(matching.total, 72);
    EXPECT_DOUBLE_EQ(matching.micro_recall(), 50.0 / 72.0);
    EXPECT_THAT(matching.column_of_row, ElementsAre(0, 1));
  }
}

TEST(MicroRecall, NullIsNeverMatched) {
  std::vector<SegmentId> truth, predicted;
  append(truth, predicted, 1, kNullId, 90);
  append(truth, predicted, 1, 4, 10);
  EXPECT_DOUBLE_EQ(match_segments(count_pairs(truth, predicted)).micro_recall(), 0.1);
}

TEST(MicroRecall, NothingLabelledIsZero) {
  const std::vector<SegmentId> truth(5, 1), predicted(5, kNullId);
  const Contingency contingency = count_pairs(truth, predicted);
  EXPECT_TRUE(contingency.predicted_ids.empty());
  EXPECT_EQ(match_segments(contingency).micro_recall(), 0.0);
  EXPECT_EQ(contingency.total(), 5);
}

TEST(MicroRecall, MoreLabelsThanTubes) {
  std::vector<SegmentId> truth, predicted;
  append(truth, predicted, 1, 7, 30);
  append(truth, predicted, 1, 8, 20);
  append(truth, predicted, 1, 9, 10);
  EXPECT_DOUBLE_EQ(match_segments(count_pairs(truth, predicted)).micro_recall(), 0.5);
}

TEST(MicroRecall, FewerLabelsThanTubes) {
  std::vector<SegmentId> truth, predicted;
  append(truth, predicted, 1, 7, 30);
  append(truth, predicted, 2, 7, 50);
  append(truth, predicted, 3, 7, 20);
  const Matching matching = match_segments(count_pairs(truth, predicted));
  EXPECT_DOUBLE_EQ(matching.micro_recall(), 0.5);
  EXPECT_THAT(matching.column_of_row, ElementsAre(kUnmatched, 0, kUnmatched));
}

TEST(MicroRecall, EqualsItsDefinitionOnRandomPoints) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    const int tubes = random.integer(1, 3);
    const int labels = random.integer(1, 3);
    std::vector<SegmentId> truth, predicted, truth_ids, predicted_ids;
    for (int k = 1; k <= tubes; ++k) truth_ids.push_back(static_cast<SegmentId>(k));
    for (int k = 1; k <= labels; ++k) predicted_ids.push_back(static_cast<SegmentId>(k));
    for (int i = 0; i < 40; ++i) {
      truth.push_back(static_cast<SegmentId>(random.integer(1, tubes)));
      predicted.push_back(static_cast<SegmentId>(random.integer(0, labels)));
    }
    EXPECT_DOUBLE_EQ(match_segments(count_pairs(truth, predicted)).micro_recall(),
                     micro_recall_by_definition(truth, predicted, truth_ids, predicted_ids));
  }
}

TEST(MicroRecall, NamesOfSegmentsDoNotMatter) {
  Random random(4);
  std::vector<SegmentId> truth, predicted, renamed;
  for (int i = 0; i < 500; ++i) {
    truth.push_back(static_cast<SegmentId>(random.integer(1, 8)));
    predicted.push_back(static_cast<SegmentId>(random.integer(0, 9)));
    renamed.push_back(predicted.back() == 0 ? 0 : 0xffffffU - 1000 * predicted.back());
  }
  EXPECT_EQ(match_segments(count_pairs(truth, predicted)).correct, match_segments(count_pairs(truth, renamed)).correct);
}

TEST(Contingency, CountsPairs) {
  const std::vector<SegmentId> truth = {5, 5, 2, 2, 2, 5};
  const std::vector<SegmentId> predicted = {0, 8, 3, 8, 0, 8};
  const Contingency c = count_pairs(truth, predicted, 2);
  EXPECT_THAT(c.truth_ids, ElementsAre(2, 5));
  EXPECT_THAT(c.predicted_ids, ElementsAre(3, 8));
  EXPECT_THAT(c.unlabeled, ElementsAre(1, 1));
  EXPECT_EQ(c.counts, (Counts(2, 2) << 1, 1, 0, 2).finished());
  EXPECT_EQ(c.total(), 6);
  EXPECT_EQ(c.truth_size(1), 3);
  EXPECT_EQ(c.predicted_size(1), 3);
  EXPECT_TRUE(c.is_bin(0));
  EXPECT_FALSE(c.is_bin(1));
}

TEST(Contingency, RefusesColoursThatAreNoSegments) {
  std::vector<SegmentId> ids(5000);
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = static_cast<SegmentId>(i + 1);
  EXPECT_THROW(count_pairs(ids, ids), IoError);
}

}  // namespace
}  // namespace tubebin::evaluation
