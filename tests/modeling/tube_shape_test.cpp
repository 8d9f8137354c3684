// Shapes that are told: their centrelines, and how far the modeler trusts them.
#include "tubebin/modeling/tube_shape.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "modeling/built_scene.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::modeling {
namespace {

using ::testing::HasSubstr;

void expect_nodes(const TubeShape& shape, const std::vector<Vec3>& expected) {
  const std::vector<Vec3> nodes = centerline_of(shape);
  ASSERT_EQ(nodes.size(), expected.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) EXPECT_LT((nodes[k] - expected[k]).norm(), 1e-12) << k;
}

TEST(TubeShape, LeadsWhereStretchesAndBendsSay) {
  expect_nodes(parse_tube_shape("0.1,90,0.2,90,0.3"), {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.2, 0}, {-0.2, 0.2, 0}});     // U
  expect_nodes(parse_tube_shape("0.1,90,0.2,90@180,0.3"), {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.2, 0}, {0.4, 0.2, 0}});  // Z
  expect_nodes(parse_tube_shape("0.1,90,0.2,90@90,0.3"), {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.2, 0}, {0.1, 0.2, 0.3}});
  expect_nodes(parse_tube_shape("0.1,90,0.2,90@-90,0.3"), {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.2, 0}, {0.1, 0.2, -0.3}});
  expect_nodes(parse_tube_shape("1,60,2"), {{0, 0, 0}, {1, 0, 0}, {2, std::sqrt(3.0), 0}});
}

TEST(TubeShape, BendsAreArcsBetweenTheStretches) {
  TubeShape hairpin = parse_tube_shape("0.2,180,0.1");
  hairpin.bend_radius = 0.05;
  const std::vector<Vec3> nodes = centerline_of(hairpin);
  EXPECT_LT((nodes.back() - Vec3(0.1, 0.1, 0)).norm(), 1e-12);
  for (std::size_t k = 1; k + 1 < nodes.size(); ++k) EXPECT_NEAR((nodes[k] - Vec3(0.2, 0.05, 0)).norm(), 0.05, 1e-12);
  EXPECT_NEAR(polyline_length(nodes), 0.3 + 0.05 * std::numbers::pi, 0.001);
}

void expect_refused(const std::string& yaml, const std::string& place, const std::string& problem) {
  ModelingOptions options;
  try {
    check(options, read_yaml_text(yaml, "m.yaml", [&](Fields& fields) { describe(fields, options); }));
    FAIL() << yaml;
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr(place));
    EXPECT_THAT(error.what(), HasSubstr(problem));
  }
}

TEST(TubeShape, RefusesWhatIsNoBentTube) {
  const auto with = [](const char* stretches) { return fmt::format("tube_shapes: [{{stretches: [{}]}}]", stretches); };
  expect_refused(with("{length: 0.1}"), "tube_shapes[0].stretches", "two or more");
  expect_refused(with("{length: 0.1}, {length: 0.1}"), "stretches[0].bend_deg", "'0' is not valid; valid: above 0");
  expect_refused(with("{length: 0.1, bend_deg: 180}, {length: 0.1}"), "stretches[0].bend_deg", "with a bend_radius");
  expect_refused(with("{length: 0.1, bend_deg: 90}, {length: 0.1, bend_deg: 5}"), "stretches[1].bend_deg",
                 "valid: 0 after the last");
  expect_refused(with("{length: 0.1, bend_deg: 190}, {length: 0.1}"), "m.yaml:1:", "valid: 0 to 180");
  expect_refused(with("{length: 70, bend_deg: 90}, {length: 100}"), "stretches[0].length", "'70' is not valid");
  expect_refused("tube_length: 0.5\n" + with("{length: 0.1, bend_deg: 90}, {length: 0.1}"), "m.yaml:2:", "tube_length");
  expect_refused("method: region_growing\n" + with("{length: 0.1, bend_deg: 90}, {length: 0.1}"),
                 "m.yaml:2:", "region_growing");
}

TEST(TubeShape, RefusesTextsOfAnotherForm) {
  for (const char* text : {"", "0.1,90", "0.1,,0.1", "0.1,9o,0.1", "0.1,90@,0.1", "0.1,90@1@2,0.1", "0.1;90;0.1"}) {
    SCOPED_TRACE(text);
    try {
      parse_tube_shape(text);
      ADD_FAILURE();
    } catch (const ConfigError& error) {
      EXPECT_THAT(error.what(), HasSubstr(fmt::format("--tube-shape {}: ", text)));
      EXPECT_THAT(error.what(), HasSubstr("0.12,90,0.05"));
    }
  }
}

constexpr double kLongLeg = 0.16, kShortLeg = 0.1, kBox = 0.14;  // metres

/// Two Ls that lie on the floor corner to corner, each corner at (0, 0) but for 3 cm and under a box.
scene::Scene two_hidden_corners() {
  const double near = 0.02, z = kRadius;
  scene::Scene scene =
      scene_of({tube_along({{near - kLongLeg, near, z}, {near, near, z}, {near, near + kShortLeg, z}}),
                tube_along({{kLongLeg - near, -near, z}, {-near, -near, z}, {-near, -near - kShortLeg, z}})});
  scene.surroundings.emplace();
  scene.surroundings->boxes.push_back({.position = {0, 0, 0.05}, .yaw_deg = 0.0, .size = {kBox, kBox, 0.02}});
  return scene;
}

ModelingResult model(const scene::Scene& scene, const cloud::Cloud& cloud, const std::string& shape) {
  ModelingOptions options = known_radius();
  if (!shape.empty()) options.tube_shapes = {parse_tube_shape(shape)};
  options.crop_min = {-1.0, -1.0, 0.0};
  options.crop_max = {1.0, 1.0, 0.04};  // below the box
  return model_tubes(input_of(cloud, scene.bin), options);
}

TEST(TubeShape, JoinsWhatIsHiddenForTheMostPart) {
  const scene::Scene scene = two_hidden_corners();
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  const ModelingResult untold = model(scene, cloud, ""), told = model(scene, cloud, "0.16,90,0.1");
  EXPECT_LT(micro_recall_of(untold, cloud), 0.9);
  EXPECT_GT(micro_recall_of(told, cloud), 0.98);
  ASSERT_EQ(told.tubes.size(), 2u);
  for (const TubeModel& tube : told.tubes) EXPECT_NEAR(tube.length(), kLongLeg + kShortLeg, 2.0 * kRadius);
  EXPECT_TRUE(told.found.doubts.empty()) << told.found.doubts.front();
  ASSERT_EQ(told.lengths.size(), 1u);
  EXPECT_NEAR(told.lengths.front(), kLongLeg + kShortLeg, kRadius);
}

TEST(TubeShape, AWrongOneIsDoubted) {
  const scene::Scene scene = two_hidden_corners();
  const ModelingResult result = model(scene, scan::scan(scene).cloud, "0.3,40,0.3");
  ASSERT_EQ(result.found.doubts.size(), 1u);
  EXPECT_THAT(result.found.doubts.front(), HasSubstr("lies on copies of the told shape"));
}

}  // namespace
}  // namespace tubebin::modeling
