#include "tubebin/evaluation/cloud_pair.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>

#include "tubebin/core/error.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::evaluation {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const float nan = std::numeric_limits<float>::quiet_NaN();

cloud::Cloud random_cloud(std::size_t size, Random& random) {
  cloud::Cloud cloud;
  for (std::size_t i = 0; i < size; ++i) {
    cloud.points.emplace_back(static_cast<float>(random.uniform(-0.3, 0.3)),
                              static_cast<float>(random.uniform(-0.2, 0.2)),
                              static_cast<float>(random.uniform(0.0, 0.2)));
    cloud.labels.push_back(static_cast<cloud::Label>(random.integer(0, 10)));
  }
  cloud.width = static_cast<std::uint32_t>(size);
  return cloud;
}

cloud::Cloud pick(const cloud::Cloud& cloud, const std::vector<std::size_t>& indices) {
  cloud::Cloud picked;
  for (const std::size_t i : indices) {
    picked.points.push_back(cloud.points[i]);
    if (!cloud.labels.empty()) picked.labels.push_back(cloud.labels[i]);
    if (!cloud.colors.empty()) picked.colors.push_back(cloud.colors[i]);
  }
  return picked;
}

std::vector<std::size_t> shuffled(std::size_t size, Random& random) {
  std::vector<std::size_t> indices(size);
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  for (std::size_t i = size; i > 1; --i)
    std::swap(indices[i - 1], indices[static_cast<std::size_t>(random.integer(0, static_cast<int>(i) - 1))]);
  return indices;
}

PairedIds pair(const cloud::Cloud& filtered, const cloud::Cloud& labeled,
               SegmentField field = SegmentField::automatic) {
  return pair_clouds({filtered, "filtered.pcd"}, {labeled, "labeled.pcd"}, field);
}

std::string error_of(const cloud::Cloud& filtered, const cloud::Cloud& labeled,
                     SegmentField field = SegmentField::automatic) {
  try {
    pair(filtered, labeled, field);
  } catch (const IoError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CloudPair, AnyOrderGivesTheSame) {
  Random random(1);
  const cloud::Cloud filtered = random_cloud(2000, random);
  const cloud::Cloud labeled = random_cloud(2000, random);
  cloud::Cloud same_places = labeled;
  same_places.points = filtered.points;
  const PairedIds straight = pair(filtered, same_places);
  const PairedIds mixed = pair(filtered, pick(same_places, shuffled(2000, random)));
  EXPECT_EQ(straight.predicted, same_places.labels);
  EXPECT_EQ(mixed.predicted, straight.predicted);
  EXPECT_EQ(mixed.truth, straight.truth);
  EXPECT_EQ(mixed.missing, 0U);
  EXPECT_EQ(mixed.bin_id, SegmentId{0});
}

TEST(CloudPair, PointsThatTheLabelledCloudLacksAreNull) {
  Random random(2);
  const cloud::Cloud filtered = random_cloud(1000, random);
  std::vector<std::size_t> kept = shuffled(1000, random);
  kept.resize(400);
  const PairedIds pairs = pair(filtered, pick(filtered, kept));
  EXPECT_EQ(pairs.missing, 600U);
  const std::vector<SegmentId> expected = [&] {
    std::vector<SegmentId> ids(1000, kNullId);
    for (const std::size_t i : kept) ids[i] = filtered.labels[i];
    return ids;
  }();
  EXPECT_EQ(pairs.predicted, expected);
}

TEST(CloudPair, TextFormatsRoundPositions) {
  Random random(3);
  const cloud::Cloud filtered = random_cloud(3000, random);
  cloud::Cloud labeled = pick(filtered, shuffled(3000, random));
  for (cloud::Point& p : labeled.points) p = (p * 1e5F).array().round() / 1e5F;
  const PairedIds pairs = pair(filtered, labeled);
  EXPECT_EQ(pairs.predicted, filtered.labels);
  EXPECT_EQ(pairs.missing, 0U);
}

TEST(CloudPair, KthDuplicateBelongsToKthDuplicate) {
  cloud::Cloud filtered;
  filtered.points = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  filtered.labels = {1, 1, 2, 3, 4};
  cloud::Cloud labeled;
  labeled.points = {{1, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 0, 0}, {-0.0F, 0, 0}};
  labeled.labels = {5, 6, 7, 8, 9};
  EXPECT_THAT(pair(filtered, labeled).predicted, ElementsAre(9, 5, 7, 8, 6));
}

TEST(CloudPair, ManyDuplicatesAreNoQuadraticWork) {
  cloud::Cloud filtered;
  filtered.points.assign(300000, cloud::Point::Zero());
  filtered.labels.assign(300000, 1);
  filtered.points.front() = {1, 1, 1};
  cloud::Cloud labeled = filtered;
  std::reverse(labeled.points.begin(), labeled.points.end());
  EXPECT_EQ(pair(filtered, labeled).missing, 0U);  // a quadratic search would take minutes
}

TEST(CloudPair, OneDuplicateTooManyIsAStranger) {
  cloud::Cloud filtered;
  filtered.points = {{0, 0, 0}, {1, 0, 0}};
  filtered.labels = {1, 1};
  cloud::Cloud labeled;
  labeled.points = {{1, 0, 0}, {1, 0, 0}};
  labeled.labels = {1, 1};
  EXPECT_THAT(error_of(filtered, labeled), HasSubstr("labeled.pcd: 1 of its 2 points are at no point of filtered.pcd"));
}

TEST(CloudPair, CloudsThatDoNotBelongTogether) {
  Random random(4);
  EXPECT_THAT(error_of(random_cloud(50, random), random_cloud(60, random)),
              AllOf(HasSubstr("labeled.pcd: 60 of its 60 points"), HasSubstr("filtered.pcd"), HasSubstr("point 0 at")));
}

TEST(CloudPair, PixelsWithoutAHitAreLeftOut) {
  cloud::Cloud filtered;
  filtered.points = {{0, 0, 0}, {nan, nan, nan}, {1, 0, 0}};
  filtered.labels = {1, 0, 2};
  filtered.width = 3;
  cloud::Cloud labeled = filtered;
  labeled.labels = {4, 0, 5};
  EXPECT_THAT(pair(filtered, labeled).truth, ElementsAre(1, 2));
  EXPECT_THAT(pair(filtered, labeled).predicted, ElementsAre(4, 5));
}

TEST(CloudPair, ColoursServeWhereThereAreNoLabels) {
  cloud::Cloud filtered;
  filtered.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  filtered.colors = {0xff0000, cloud::kNullColor, 0x00ff00};
  cloud::Cloud labeled = filtered;
  labeled.colors = {cloud::kNullColor, 0x111111, 0x222222};
  const PairedIds pairs = pair(filtered, labeled);
  EXPECT_THAT(pairs.truth, ElementsAre(0xff0000, 0x00ff00));
  EXPECT_THAT(pairs.predicted, ElementsAre(kNullId, 0x222222));
  EXPECT_EQ(pairs.unannotated, 1U);
  EXPECT_FALSE(pairs.bin_id);
}

TEST(CloudPair, LabelsAndColoursThatDisagreeAreAnError) {
  cloud::Cloud filtered;
  filtered.points = {{0, 0, 0}, {1, 0, 0}};
  filtered.labels = {1, 2};
  cloud::Cloud recolored = filtered;  // a program that set colours and passed the ground truth's labels on
  recolored.colors = {0x101010, 0x101010};
  EXPECT_THAT(error_of(filtered, recolored),
              AllOf(HasSubstr("labeled.pcd: its labels and its colours"), HasSubstr("--field")));
  EXPECT_THAT(pair(filtered, recolored, SegmentField::label).predicted, ElementsAre(1, 2));
  EXPECT_THAT(error_of(filtered, recolored, SegmentField::color), HasSubstr("filtered.pcd: has no colours"));
}

TEST(CloudPair, CloudsWithoutLabelsAndColours) {
  cloud::Cloud bare;
  bare.points = {{0, 0, 0}};
  cloud::Cloud labelled = bare;
  labelled.labels = {1};
  EXPECT_THAT(error_of(bare, labelled), HasSubstr("filtered.pcd: has neither a label field nor colours"));
  EXPECT_THAT(error_of(labelled, bare), HasSubstr("labeled.pcd: has neither"));
  EXPECT_THAT(error_of(cloud::Cloud{}, labelled), HasSubstr("filtered.pcd: has no point"));
}

TEST(CloudPair, AnEmptyLabelledCloudLabelsNothing) {
  cloud::Cloud filtered;
  filtered.points = {{0, 0, 0}};
  filtered.labels = {1};
  EXPECT_EQ(pair(filtered, cloud::Cloud{}).missing, 1U);
}

}  // namespace
}  // namespace tubebin::evaluation
