// What a configuration leaves open: checked before the first scene, then drawn by seeds.
#include "dataset/randomization.hpp"

#include <gmock/gmock.h>

#include <set>

#include "core/number_fields.hpp"
#include "support/program.hpp"

namespace tubebin::dataset {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Key;

DatasetConfig parsed(const std::string& text) {
  DatasetConfig config;
  check(config, read_yaml_text(text, "c.yaml", fields_of(config)));
  return config;
}

std::string problem_of(const std::string& text) {
  try {
    parsed(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "accepted";
}

std::vector<tube::Tube> tubes_of(const DatasetConfig& config, std::uint64_t seed, int count = 20) {
  Random random(seed);
  return make_tubes(with_numbers(config, draw_scene_numbers(config, seed)), count, seed, random);
}

TEST(Randomization, TubesNumbersAreDrawnPerTubeAndAllOthersPerScene) {
  const DatasetConfig config = parsed(
      "tube: {radius: {uniform: [0.008, 0.016]}, mass: {uniform: [0.1, 0.2], per: scene}}\n"
      "physics: {friction_tube: {uniform: [0.5, 1]}}\nscanner: {position: [0, {uniform: [-1, 1]}, 2]}\n");
  const DrawnNumbers scene = draw_scene_numbers(config, 5);
  EXPECT_THAT(scene, ElementsAre(Key("physics.friction_tube"), Key("scanner.position[1]"), Key("tube.mass")));
  const DatasetConfig drawn = with_numbers(config, scene);
  EXPECT_EQ(drawn.physics.friction_tube, scene.at("physics.friction_tube"));
  EXPECT_EQ(drawn.scanner.position, Vec3(0, scene.at("scanner.position[1]"), 2));
  std::set<double> radii;
  for (const tube::Tube& tube : tubes_of(config, 5)) {
    EXPECT_EQ(tube.mass, scene.at("tube.mass"));
    EXPECT_THAT(tube.drawn, ElementsAre(std::pair(std::string("tube.radius"), tube.radius)));
    EXPECT_TRUE(tube.radius >= 0.008 && tube.radius < 0.016) << tube.radius;
    radii.insert(tube.radius);
  }
  EXPECT_EQ(radii.size(), 20u);
}

TEST(Randomization, TheSameSeedGivesTheSameAndAnotherRangeLeavesTheOthers) {
  const std::string friction = "physics: {friction_tube: {uniform: [0.5, 1]}";
  const DatasetConfig one = parsed(friction + "}\n");
  const DatasetConfig two = parsed(friction + ", friction_bin: {uniform: [0.5, 1]}}\n");
  const DrawnNumbers drawn = draw_scene_numbers(one, 7);
  EXPECT_EQ(draw_scene_numbers(one, 7), drawn);
  EXPECT_NE(draw_scene_numbers(one, 8), drawn);
  DrawnNumbers more = draw_scene_numbers(two, 7);
  EXPECT_NE(more.at("physics.friction_bin"), more.at("physics.friction_tube"));
  more.erase("physics.friction_bin");
  EXPECT_EQ(more, drawn);
}

TEST(Randomization, ShapesStayWhereARadiusIsDrawn) {
  const std::vector<tube::Tube> plain = tubes_of(parsed("seed: 1\n"), 3);
  const std::vector<tube::Tube> drawn = tubes_of(parsed("tube: {radius: {uniform: [0.008, 0.016]}}\n"), 3);
  for (std::size_t k = 0; k < plain.size(); ++k) {
    EXPECT_EQ(drawn[k].nodes, plain[k].nodes);
    EXPECT_THAT(plain[k].drawn, IsEmpty());
  }
}

TEST(Randomization, KindsHaveRangesOfTheirOwn) {
  const DatasetConfig config = parsed(
      "tubes: [20]\nkinds:\n  - {name: thin, share: 1, radius: {uniform: [0.005, 0.006]}}\n"
      "  - {name: ring, share: 1, shape: ring, radius: 0.009, cylinder_count: {choice: [12, 24]}}\n");
  std::set<std::size_t> corners;
  for (const tube::Tube& tube : tubes_of(config, 1)) {
    EXPECT_THAT(tube.drawn, ElementsAre(Key(tube.kind == "thin" ? "kinds[0].radius" : "kinds[1].cylinder_count")));
    EXPECT_EQ(tube.kind == "thin", tube.radius <= 0.006);
    if (tube.kind == "ring") corners.insert(tube.nodes.size());
  }
  EXPECT_THAT(corners, ElementsAre(12u, 24u));
}

TEST(Randomization, ScannersTakeTheRangesOfAnIncludedScanner) {
  const testing::TemporaryFolder folder;
  testing::write_text(folder / "base.yaml", "scanner: {position: [0, 0, {uniform: [1, 2]}]}\n");
  testing::write_text(folder / "own.yaml", "include: base.yaml\nscanners: [{}, {position: [0.1, 0, 2]}, {}]\n");
  const DatasetConfig config = load_config(folder / "own.yaml");
  EXPECT_THAT(draw_scene_numbers(config, 1),
              ElementsAre(Key("scanners[0].position[2]"), Key("scanners[2].position[2]")));
  EXPECT_THAT(format_config(config), HasSubstr("position: [0, 0, {uniform: [1, 2]}]"));
}

TEST(Randomization, RangesThatContradictEachOtherAreRefusedAtTheirEnds) {
  EXPECT_THAT(problem_of("tube: {radius: {uniform: [0.004, 0.016]}, wall_thickness: {uniform: [0.001, 0.005]}}\n"),
              HasSubstr("c.yaml:1:59: tube.wall_thickness: 0.005 m leaves no bore in a radius of 0.004 m"));
  EXPECT_THAT(problem_of("tube: {length: {uniform: [0.05, 0.5]}}\n"), HasSubstr("length = 0.05 m"));
  EXPECT_THAT(problem_of("scanner: {range_max: {uniform: [0.05, 3]}}\n"), HasSubstr("scanner.range_max: 0.05 m"));
  EXPECT_THAT(problem_of("scanner: {position: [0, 0, {uniform: [-0.01, 2]}]}\n"), HasSubstr("scanner.position"));
  EXPECT_EQ(problem_of("tube: {radius: {uniform: [0.006, 0.016]}, wall_thickness: {uniform: [0.001, 0.005]}}\n"),
            "accepted");
}

TEST(Randomization, WhatIsOneForAllScenesIsRefused) {
  const std::string reason = "valid: one number, for all scenes";
  EXPECT_THAT(problem_of("cases: {uniform: [1, 5]}\n"), HasSubstr("c.yaml:1:8: cases: '{uniform: [1, 5]}' is not"));
  EXPECT_THAT(problem_of("attempts_max: {uniform: [1, 5]}\n"), HasSubstr(reason));
  EXPECT_THAT(problem_of("attempt_time_limit: {uniform: [1, 5]}\n"), HasSubstr(reason));
  EXPECT_THAT(problem_of("sequence: {lifts: {uniform: [1, 5]}}\n"), HasSubstr(reason));
  EXPECT_THAT(problem_of("kinds: [{count: {uniform: [1, 5]}}]\n"), HasSubstr("kinds[0].count: "));
  EXPECT_THAT(problem_of("kinds: [{share: {uniform: [1, 5]}}]\n"), HasSubstr(reason));
  EXPECT_THAT(problem_of("seed: {uniform: [1, 5]}\n"), HasSubstr("c.yaml:1:7: seed: "));
  EXPECT_THAT(problem_of("tubes: [{uniform: [1, 5]}]\n"), HasSubstr("tubes[0]: "));
  EXPECT_THAT(problem_of("output: {preview: {choice: [0, 1]}}\n"), HasSubstr("output.preview: "));
  EXPECT_THAT(problem_of("physics: {gravity: {uniform: [9, 10], per: tube}}\n"), HasSubstr("since tubes share it"));
}

TEST(LookAt, MeetsThePointWithALevelImage) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 position(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
    const Vec3 target(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
    scene::Scanner scanner;
    scanner.position = position;
    scanner.rotation_deg = scene::rotation_deg_towards(target, position);
    const Pose scanner_from_world = scanner.world_from_scanner().inverse();
    const Vec3 seen = scanner_from_world * target;
    EXPECT_LT(seen.head<2>().norm(), 1e-12);
    EXPECT_NEAR(seen.z(), (target - position).norm(), 1e-12);
    const Eigen::Matrix3d axes = scanner.world_from_scanner().linear();
    EXPECT_NEAR(axes(2, 0), 0.0, 1e-15);  // image x is level
    EXPECT_LE(axes(2, 1), 0.0);           // image y points down
  }
  EXPECT_EQ(scene::rotation_deg_towards({0, 0, 0}, {0, 0, 2}), Vec3::Zero());
}

TEST(LookAt, StandsInsteadOfTheRotation) {
  const DatasetConfig config = parsed("scanner: {position: [0, -2, 2], look_at: [0, 0, 0]}\n");
  EXPECT_TRUE(config.all_scanners().at(0).rotation_deg.isApprox(Vec3(45, 0, 0), 1e-15));
  EXPECT_THAT(format_config(config), HasSubstr("look_at: [0, 0, 0]"));
  EXPECT_EQ(format_config(DatasetConfig{}).find("look_at"), std::string::npos);
  EXPECT_THAT(problem_of("scanner: {rotation_deg: [0, 9, 0], look_at: [0, 0, 0]}\n"),
              HasSubstr("c.yaml:1:25: scanner.rotation_deg: look_at says where the scanner looks"));
  EXPECT_THAT(problem_of("scanner: {look_at: [0, 0, 2]}\n"), HasSubstr("scanner.look_at: is the scanner's position"));
}

}  // namespace
}  // namespace tubebin::dataset
