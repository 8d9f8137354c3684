/// Reasons and verdicts on contingencies whose errors are known.
#include "evaluation/report/verdict.hpp"

#include <gmock/gmock.h>

namespace tubebin::evaluation {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Rows are the bin and tubes 1, 2, ..., columns are segments.
Contingency contingency(const std::vector<std::vector<std::int64_t>>& counts, std::vector<std::int64_t> unlabeled) {
  Contingency c;
  c.bin_id = 0;
  c.unlabeled = std::move(unlabeled);
  c.counts.resize(static_cast<Eigen::Index>(counts.size()), static_cast<Eigen::Index>(counts.front().size()));
  for (std::size_t row = 0; row < counts.size(); ++row) {
    c.truth_ids.push_back(static_cast<SegmentId>(row));
    for (std::size_t column = 0; column < counts[row].size(); ++column)
      c.counts(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) = counts[row][column];
  }
  for (std::size_t column = 0; column < counts.front().size(); ++column)
    c.predicted_ids.push_back(static_cast<SegmentId>(column + 1));
  return c;
}

RunScore run_of(const Contingency& c, const std::string& scene = "A2/001", double ratio = 1.0) {
  RunKey key = parse_scene_name(scene);
  key.method = "mine";
  key.ratio = ratio;
  return score_run(key, c, match_segments(c, BinPoints::left_out), nullptr, {});
}

Contingency perfect() { return contingency({{0, 0}, {100, 0}, {0, 100}}, {50, 0, 0}); }
/// Tube 1 lies in segments 1 and 2, tube 2 in segment 3.
Contingency split() { return contingency({{0, 0, 0}, {60, 40, 0}, {0, 0, 100}}, {50, 0, 0}); }

TEST(Losses, CountEveryWrongPointOnce) {
  // Tube 1: 60 in its segment, 25 in a further one, 10 in tube 2's, 5 in none. Ten points of the bin are in segment 1.
  const Losses lost = losses(run_of(contingency({{10, 0, 0}, {60, 25, 10}, {0, 0, 100}}, {40, 5, 0})).scores);
  EXPECT_EQ(lost.split, 25);
  EXPECT_EQ(lost.merged, 10);
  EXPECT_EQ(lost.missed, 5);
  EXPECT_EQ(lost.background, 10);
  EXPECT_EQ(lost.total(), 50);
}

TEST(Losses, PointsAndLossesOfATubeAddUp) {
  const RunScore run = run_of(contingency({{3, 0, 20}, {30, 25, 12}, {40, 1, 7}}, {40, 5, 9}));
  for (const TubeScore& tube : run.scores.tubes)
    EXPECT_EQ(tube.correct + tube.split + tube.merged + tube.missed, tube.points);
}

TEST(Reasons, NameTheTubes) {
  EXPECT_EQ(describe_errors(run_of(split())), "Tube 1 is split.");
  EXPECT_EQ(describe_errors(run_of(contingency({{0}, {100}, {90}}, {50, 0, 0}))), "Tube 2 is merged with others.");
  EXPECT_EQ(describe_errors(run_of(contingency({{0, 0}, {100, 0}, {0, 0}, {0, 9}}, {50, 0, 100, 91}))),
            "Tubes 2 and 3 are missed.");
  EXPECT_EQ(describe_errors(run_of(contingency({{100}, {100}}, {0, 0}))),
            "Background is taken for tube: 50.0 % of the points in segments.");
  EXPECT_EQ(describe_errors(run_of(perfect())), "No tube loses more than a fifth of its points.");
}

TEST(Reasons, StandMostPointsFirst) {
  EXPECT_EQ(reasons_text({}), "-");
  EXPECT_EQ(reasons_text({10, 50, 40, 0}), "merged, missed");
  EXPECT_EQ(reasons_text({0, 0, 0, 7}), "background");
}

VerdictText verdict_of(const std::vector<RunScore>& runs) {
  std::vector<const RunScore*> pointers;
  for (const RunScore& run : runs) pointers.push_back(&run);
  return describe_results(pointers, summarize_scenes(runs));
}

TEST(Verdict, OfPerfectRuns) {
  const VerdictText text = verdict_of({run_of(perfect(), "A2/001"), run_of(perfect(), "A2/002")});
  EXPECT_EQ(text.headline, "mine finds every tube");
  EXPECT_THAT(text.how_good, AllOf(HasSubstr("100.00 % of the points"), HasSubstr("100.00 % of the tubes")));
  EXPECT_THAT(text.how_sure, AllOf(HasSubstr("over 2 scenes"), HasSubstr("So few scenes")));
  EXPECT_EQ(text.where_it_fails, "No point of a tube is wrong.");
}

TEST(Verdict, SaysWhereItFails) {
  const VerdictText text = verdict_of({run_of(perfect(), "A2/001", 1.0), run_of(split(), "A2/001", 0.1),
                                       run_of(perfect(), "A5/001", 1.0), run_of(split(), "A5/001", 0.1)});
  EXPECT_EQ(text.headline, "mine finds more than half of the tubes");  // six of eight
  EXPECT_THAT(text.how_good, HasSubstr("90.00 % of the points"));
  EXPECT_THAT(text.where_it_fails, AllOf(HasSubstr("100 % lie in tubes that are split"),
                                         HasSubstr("ratio 0.1 (80.00 %)"), Not(HasSubstr("with 2 tubes"))));
}

TEST(Verdict, TheIntervalIsOverScenesNotRuns) {
  std::vector<RunScore> runs;
  for (const double ratio : {0.1, 0.2, 0.3, 0.4, 0.5, 1.0}) runs.push_back(run_of(split(), "A2/001", ratio));
  EXPECT_EQ(verdict_of(runs).how_sure, "One scene says nothing about others.");
}

TEST(Scenes, TheWorstComesFirst) {
  const std::vector<RunScore> runs = {run_of(perfect(), "A2/001"), run_of(split(), "A2/002"),
                                      run_of(perfect(), "A2/002", 0.5)};
  const std::vector<SceneSummary> scenes = summarize_scenes(runs);
  ASSERT_EQ(scenes.size(), 2U);
  EXPECT_EQ(scenes[0].scene, "A2/002");
  EXPECT_DOUBLE_EQ(scenes[0].micro_recall, 0.9);
  EXPECT_DOUBLE_EQ(scenes[0].detected, 0.75);
  EXPECT_EQ(scenes[0].worst, &runs[1]);
}

}  // namespace
}  // namespace tubebin::evaluation
