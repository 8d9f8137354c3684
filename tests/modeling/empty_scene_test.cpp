// Scenes without a tube.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "modeling/built_scene.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/random.hpp"
#include "tubebin/modeling/pipeline.hpp"

namespace tubebin::modeling {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(EmptyScene, MakesNoTubesOfNoise) {
  Random random(9);
  std::vector<cloud::Point> points;
  for (int i = 0; i < 5000; ++i)
    points.emplace_back(static_cast<float>(random.uniform(-0.25, 0.25)),
                        static_cast<float>(random.uniform(-0.15, 0.15)),
                        static_cast<float>(random.uniform(0.01, 0.19)));
  const ModelingInput input{
      .points = points, .world_from_sensor = scene::Scanner{}.world_from_scanner(), .bin = scene::Bin{}};
  for (const ModelingMethod method : {ModelingMethod::centerline, ModelingMethod::region_growing})
    EXPECT_TRUE(model_tubes(input, known_radius(method)).tubes.empty());
}

TEST(EmptyScene, AFlatCloudWithHardlyAPointMoreHasNoTubes) {
  Random random(10);
  std::vector<cloud::Point> table;
  for (int i = 0; i < 50000; ++i)
    table.emplace_back(static_cast<float>(random.uniform(-0.25, 0.25)), static_cast<float>(random.uniform(-0.15, 0.15)),
                       static_cast<float>(1e-4 * random.normal()));
  for (const std::vector<cloud::Point>& more : {std::vector<cloud::Point>{{0.1f, 0.0f, 0.1f}},
                                                {{0.1f, 0.0f, 0.1f}, {0.1f, 0.0f, 0.1f}, {0.1f, 0.0f, 0.1000001f}}}) {
    std::vector<cloud::Point> points = table;
    points.insert(points.end(), more.begin(), more.end());
    const ModelingResult found =
        model_tubes({.points = points, .world_from_sensor = scene::Scanner{}.world_from_scanner(), .bin = {}}, {});
    EXPECT_TRUE(found.tubes.empty());
    EXPECT_EQ(found.found.doubts.size(), 1u);
  }
}

TEST(EmptyScene, AnEmptyBinHasNoTubes) {
  const cloud::Cloud cloud = scan::scan(scene_of({})).cloud;
  ModelingOptions all = known_radius();
  all.label_all = true;
  for (const ModelingInput& input :
       {input_of(cloud, scene::Bin{}),
        ModelingInput{.points = cloud.points, .world_from_sensor = cloud.world_from_sensor, .bin = {}}})
    for (const ModelingOptions& options : {ModelingOptions{}, all, known_radius(ModelingMethod::region_growing)}) {
      const ModelingResult found = model_tubes(input, options);
      EXPECT_TRUE(found.tubes.empty());
      EXPECT_EQ(std::ranges::count(found.labels, cloud::Label{0}), std::ssize(found.labels));
      EXPECT_THAT(found.found.doubts, ElementsAre(HasSubstr("nothing in the cloud is round")));
    }
}

TEST(EmptyScene, ABoxWithoutAPointIsRefusedAndOneOfFloorIsEmpty) {
  const cloud::Cloud cloud = scan::scan(scene_of({})).cloud;
  const ModelingInput input{.points = cloud.points, .world_from_sensor = cloud.world_from_sensor, .bin = {}};
  ModelingOptions options;
  options.crop_min = Vec3(-0.1, -0.1, -0.01), options.crop_max = Vec3(0.1, 0.1, 0.1);
  EXPECT_TRUE(model_tubes(input, options).tubes.empty());
  options.crop_min = Vec3(5, 5, 5), options.crop_max = Vec3(6, 6, 6);
  EXPECT_THROW(model_tubes(input, options), IoError);
}

TEST(EmptyScene, ACloudWithoutAPointInTheBinIsRefused) {
  const std::vector<cloud::Point> points = {cloud::Point(5, 5, 0.1f), cloud::Point(6, 5, 0.1f)};
  const ModelingInput input{.points = points, .world_from_sensor = Pose::Identity(), .bin = scene::Bin{}};
  EXPECT_THROW(model_tubes(input, known_radius()), IoError);
}

}  // namespace
}  // namespace tubebin::modeling
