// Every shape from its configuration to a verified data set, as a user makes it.
#include <gmock/gmock.h>

#include <algorithm>

#include "support/commands.hpp"
#include "support/program.hpp"
#include "tubebin/dataset/dataset_config.hpp"
#include "tubebin/physics/drop_simulator.hpp"
#include "tubebin/scene/scene_json.hpp"
#include "tubebin/scene/tubes_txt.hpp"

namespace tubebin::testing {

using namespace dataset;
namespace {

using ::testing::HasSubstr;

std::string source_file(const std::string& name) { return TUBEBIN_SOURCE_DIR "/" + name; }

/// Makes one scene of `tubes` objects and verifies it.
scene::SceneRecord make_one(const TemporaryFolder& folder, const std::string& config, const std::string& set,
                            int tubes) {
  const std::string data = folder / "data";
  const ProgramResult made = run_generate_dataset(
      {config, "--output", data, "--tubes", fmt::format("{}", tubes), "--cases", "1", "--jobs", "1"});
  EXPECT_EQ(made.exit_code, 0) << made.error;
  const ProgramResult verified = run_generate_dataset({"--verify", data, "--jobs", "1"});
  EXPECT_EQ(verified.exit_code, 0) << verified.out;
  const std::string scene = fmt::format("{}/{}{}/001", data, set, tubes);
  expect_schema("scene.schema.json", scene + "/scene.json");
  EXPECT_EQ(scene::read_tubes_txt(scene + "/tubes.txt").size(), static_cast<std::size_t>(tubes));
  return scene::read_scene_json(scene + "/scene.json");
}

TEST(ShapeScenes, PublishedSetCHasTheTreesOfThePublishedFiles) {
  const TemporaryFolder folder;
  const scene::SceneRecord record = make_one(folder, source_file("config/published_c.yaml"), "C", 4);
  // As in the published files: 1-2 of 0.30 m with 1-3, 1-4 of 0.10 m; 2-5 of 0.10 m and 2-6 of 0.15 m.
  for (const scene::PlacedTube& placed : record.scene.tubes) {
    const std::vector<int> degrees = placed.tube.node_degrees();
    EXPECT_EQ(std::ranges::count(degrees, 3), 2);
    EXPECT_EQ(std::ranges::count(degrees, 1), 4);
    EXPECT_NEAR(placed.tube.length(), 0.75, 1e-9);
    EXPECT_EQ(scene::centerline_paths(placed.tube).size(), 5u);
  }
}

TEST(ShapeScenes, AMixedBinHasAllKinds) {
  const TemporaryFolder folder;
  const scene::SceneRecord record = make_one(folder, source_file("config/mixed.yaml"), "mixed", 6);
  const auto is_ball = [](const scene::PlacedTube& placed) { return placed.tube.cylinders.empty(); };
  EXPECT_EQ(std::ranges::count_if(record.scene.tubes, is_ball), 1);
  for (const scene::PlacedTube& placed : record.scene.tubes) {
    const tube::Tube& tube = placed.tube;
    const std::vector<int> degrees = tube.node_degrees();
    const char* const kind = is_ball(placed)                       ? "ball"
                             : tube.wall_thickness > 0.0           ? "pipe"
                             : std::ranges::count(degrees, 3) == 1 ? "fork"
                             : std::ranges::count(degrees, 1) == 0 ? "ring"
                                                                   : "hose";
    EXPECT_EQ(tube.kind, kind);
  }
}

struct InscribedBall {
  Vec3 center;
  double radius = 0.0;
};

/// Balls that lie within the object, a millimetre apart along its cylinders.
std::vector<InscribedBall> inscribed_balls(const scene::PlacedTube& placed) {
  const tube::Tube& tube = placed.tube;
  const std::vector<int> degrees = tube.node_degrees();
  std::vector<InscribedBall> balls;
  for (const tube::Cylinder& cylinder : tube.cylinders) {
    const Vec3 a = placed.node_in_world(cylinder.node_a), b = placed.node_in_world(cylinder.node_b);
    const auto is_free = [&](int node) { return degrees[static_cast<std::size_t>(node)] == 1; };
    const double length = (b - a).norm();
    for (double along = 0.0; along <= length; along += 0.001) {
      double radius = tube.radius_of(cylinder);
      if (is_free(cylinder.node_a)) radius = std::min(radius, along);
      if (is_free(cylinder.node_b)) radius = std::min(radius, length - along);
      balls.push_back({a + along / length * (b - a), radius});
    }
  }
  if (tube.cylinders.empty()) balls.push_back({placed.node_in_world(0), tube.radius});
  return balls;
}

double deepest_overlap(const std::vector<InscribedBall>& first, const std::vector<InscribedBall>& second) {
  double deepest = 0.0;
  for (const InscribedBall& p : first)
    for (const InscribedBall& q : second)
      deepest = std::max(deepest, p.radius + q.radius - (p.center - q.center).norm());
  return deepest;
}

TEST(ShapeScenes, NoObjectOfAMixedBinLiesInAnother) {
  const TemporaryFolder folder;
  const std::string data = folder / "data";
  const ProgramResult made = run_generate_dataset(
      {source_file("config/mixed.yaml"), "--output", data, "--tubes", "5,10", "--cases", "4", "--jobs", "1"});
  ASSERT_EQ(made.exit_code, 0) << made.error;
  for (const int tubes : {5, 10})
    for (int scene = 1; scene <= 4; ++scene) {
      const std::string file = fmt::format("{}/mixed{}/{:03}/scene.json", data, tubes, scene);
      std::vector<std::vector<InscribedBall>> objects;
      for (const scene::PlacedTube& placed : scene::read_scene_json(file).scene.tubes)
        objects.push_back(inscribed_balls(placed));
      for (std::size_t i = 0; i < objects.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
          EXPECT_LT(deepest_overlap(objects[i], objects[j]), physics::PhysicsOptions{}.penetration_max)
              << file << ", objects " << j + 1 << " and " << i + 1;
    }
}

TEST(ShapeScenes, EachShapeAloneIsMadeAndVerified) {
  for (const char* shape : {"ring", "sphere", "curve"}) {
    const TemporaryFolder folder;
    const std::string config = folder / "config.yaml";
    write_text(config, fmt::format("set: Q\nseed: 5\nscanner: {{width: 320, height: 200}}\ntube: {{shape: {}, "
                                   "wall_thickness: 0.002}}\n",
                                   shape));
    make_one(folder, config, "Q", 2);
  }
}

TEST(ShapeScenes, ACurveWhoseRadiusVariesIsMadeAndVerified) {
  for (const double wall : {0.0, 0.002}) {
    const TemporaryFolder folder;
    const std::string config = folder / "config.yaml";
    write_text(config, fmt::format("set: Q\nseed: 5\nscanner: {{width: 640, height: 400}}\noutput: {{preview: true}}\n"
                                   "tube: {{shape: curve, radius: 0.01, radius_variation: 0.4, wall_thickness: {}}}\n",
                                   wall));
    const scene::SceneRecord record = make_one(folder, config, "Q", 3);
    const auto from_text = scene::read_tubes_txt(folder / "data/Q3/001/tubes.txt");
    for (std::size_t k = 0; k < 3; ++k) {
      const tube::Tube &tube = record.scene.tubes[k].tube, &text = from_text[k].tube;
      EXPECT_GT(tube.radius_max(), 0.0101);
      for (std::size_t i = 0; i < tube.cylinders.size(); ++i)
        EXPECT_NEAR(text.radius_of(text.cylinders[i]), tube.radius_of(tube.cylinders[i]), 1e-12);
    }
  }
}

TEST(ShapeScenes, KindsThatCannotBeAreNamedWithTheirPlace) {
  const TemporaryFolder folder;
  const std::string config = folder / "config.yaml";
  const auto problem = [&](const std::string& yaml) {
    write_text(config, yaml);
    const ProgramResult result = run_generate_dataset({config, "--output", folder / "data"});
    EXPECT_EQ(result.exit_code, 2);
    return result.error;
  };
  EXPECT_THAT(problem("kinds:\n  - {shape: ring}\n"),
              HasSubstr("config.yaml:2:5: kinds[0]: neither a count nor a share"));
  EXPECT_THAT(problem("kinds:\n  - {share: 1, radius: 0.1, shape: ring}\n"),
              HasSubstr("config.yaml:2:5: kinds[0].diameter_min: 0.1 m leaves no hole"));
  EXPECT_THAT(problem("tubes: [2, 3]\nkinds:\n  - {count: 3}\n"),
              HasSubstr("config.yaml:1:8: tubes: 2 tubes are fewer"));
  EXPECT_THAT(problem("kinds:\n  - {share: 1}\ntube: {radius: 0.01}\n"),
              HasSubstr("config.yaml:3:1: tube: unknown key"));
}

}  // namespace
}  // namespace tubebin::testing
