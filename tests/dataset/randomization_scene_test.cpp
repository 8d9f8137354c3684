// Data sets of a configuration that leaves numbers open, as a user makes and checks them.
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include <set>

#include "dataset/verify_scene.hpp"
#include "support/commands.hpp"
#include "support/program.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/file_record.hpp"
#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/scene/dataset_files.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::testing {

using namespace dataset;
namespace {

using ::testing::HasSubstr;

constexpr const char* kConfig = R"(set: Q
seed: 5
tubes: [3]
cases: 4
tube: {radius: {uniform: [0.008, 0.016]}, mass: {choice: [0.05, 0.1], per: scene}}
bin: {height: {uniform: [0.15, 0.25]}}
physics: {friction_tube: {normal: [0.9, 0.1]}, penetration_max: {uniform: [0.0005, 0.0006]}}
scanner:
  width: 640
  height: 400
  position: [{uniform: [-0.6, 0.6]}, {uniform: [-0.6, 0.6]}, {uniform: [1.5, 2]}]
  look_at: [0, {normal: [0, 0.02]}, 0.05]
  effects: {range_noise: {sigma: {log_uniform: [0.0001, 0.0005]}}}
)";

class RandomizedScenes : public ::testing::Test {
 protected:
  void SetUp() override {
    write_text(config_, kConfig);
    ASSERT_EQ(generate(data_, {"--jobs", "2"}).exit_code, 0);
  }
  ProgramResult generate(const std::string& output, std::vector<std::string> more) {
    more.insert(more.begin(), {config_, "--output", output});
    return run_generate_dataset(more);
  }
  std::string scene_path(int number) const { return fmt::format("{}/Q3/{:03}", data_, number); }

  /// The problems that are found after scene 1's record was changed, and the manifest's hash with it.
  std::string problems_with(const scene::SceneRecord& changed) {
    ManifestRecord record = *Manifest(data_).find("Q3/001");
    const std::string bytes = scene::format_scene_json(changed);
    write_text(scene_path(1) + "/scene.json", bytes);
    record.files["scene.json"] = record_bytes(bytes);
    return fmt::format(
        "{}",
        fmt::join(verify_scene(scene::DatasetFiles(data_), read_dataset_config(data_), {"Q", 3, 1}, record), "\n"));
  }

  TemporaryFolder folder_;
  std::string config_ = folder_ / "config.yaml";
  std::string data_ = folder_ / "data";
};

TEST_F(RandomizedScenes, SayWhatWasDrawnAndAreVerifiedByIt) {
  const ProgramResult verified = run_generate_dataset({"--verify", data_});
  EXPECT_EQ(verified.exit_code, 0) << verified.out;
  expect_schema("scene.schema.json", scene_path(1) + "/scene.json");
  std::set<double> heights, radii;
  for (int number = 1; number <= 4; ++number) {
    const scene::SceneRecord record = scene::read_scene_json(scene_path(number) + "/scene.json");
    EXPECT_EQ(record.scene.bin.height, record.drawn.at("bin.height"));
    EXPECT_EQ(record.scene.scanner.position.x(), record.drawn.at("scanner.position[0]"));
    EXPECT_EQ(record.scene.scanner.effects.range_noise.sigma, record.drawn.at("scanner.effects.range_noise.sigma"));
    const Vec3 target(0, record.drawn.at("scanner.look_at[1]"), 0.05);
    EXPECT_LT((record.scene.scanner.world_from_scanner().inverse() * target).head<2>().norm(), 1e-9);
    EXPECT_TRUE(cloud::read_cloud(scene_path(number) + "/cloud.pcd")
                    .world_from_sensor.isApprox(record.scene.scanner.world_from_scanner(), 1e-6));
    heights.insert(record.scene.bin.height);
    for (const scene::PlacedTube& placed : record.scene.tubes) {
      EXPECT_EQ(placed.tube.radius, placed.tube.drawn.at("tube.radius"));
      EXPECT_EQ(placed.tube.mass, record.drawn.at("tube.mass"));
      radii.insert(placed.tube.radius);
    }
  }
  EXPECT_EQ(heights.size(), 4u);
  EXPECT_EQ(radii.size(), 12u);
}

TEST_F(RandomizedScenes, HaveTheSameBytesWhicheverShardMakesThem) {
  for (const char* shard : {"1/2", "2/2"})
    ASSERT_EQ(generate(folder_ / "shards", {"--shard", shard, "--jobs", "1"}).exit_code, 0);
  for (int number = 1; number <= 4; ++number)
    for (const char* file : {"scene.json", "cloud.pcd", "tubes.txt"})
      EXPECT_EQ(read_text(fmt::format("{}/Q3/{:03}/{}", folder_ / "shards", number, file)),
                read_text(scene_path(number) + "/" + file));
  EXPECT_THAT(generate(data_, {}).error, HasSubstr("0 made"));
  std::string other = kConfig;
  other.replace(other.find("0.016"), 5, "0.015");
  write_text(config_, other);
  EXPECT_THAT(generate(data_, {}).error,
              HasSubstr("tube.radius: {uniform: [0.008, 0.016]} there, {uniform: [0.008, 0.015]} here"));
}

TEST_F(RandomizedScenes, ANumberThatTheSeedDoesNotGiveIsFound) {
  const scene::SceneRecord sound = scene::read_scene_json(scene_path(1) + "/scene.json");
  EXPECT_EQ(problems_with(sound), "");
  scene::SceneRecord friction = sound;
  friction.drawn["physics.friction_tube"] += 0.001;
  EXPECT_THAT(problems_with(friction), HasSubstr("other drawn numbers than its seed gives"));
  scene::SceneRecord radius = sound;
  radius.scene.tubes[1].tube.drawn["tube.radius"] += 1e-6;
  EXPECT_THAT(problems_with(radius), HasSubstr("tube 2 has other drawn numbers"));
  scene::SceneRecord moved = sound;
  moved.scene.scanner.position.x() += 1e-6;
  EXPECT_THAT(problems_with(moved), HasSubstr("other scanners than config.yaml"));
}

TEST_F(RandomizedScenes, StepsOfAPileShareWhatWasDrawn) {
  ASSERT_EQ(generate(folder_ / "emptied", {"--empty", "2", "--cases", "1"}).exit_code, 0);
  const ProgramResult verified = run_generate_dataset({"--verify", folder_ / "emptied"});
  EXPECT_EQ(verified.exit_code, 0) << verified.out;
  const auto drawn = [&](int step) {
    return scene::read_scene_json(fmt::format("{}/Q3/001/step_{:02}/scene.json", folder_ / "emptied", step)).drawn;
  };
  EXPECT_FALSE(drawn(0).empty());
  EXPECT_EQ(drawn(2), drawn(0));
}

TEST_F(RandomizedScenes, GazeboGoesOnWithTheFrictionThatWasDrawn) {
  const ProgramResult exported =
      Program({program_path("export_dataset"), data_, "--format", "sdf", "--output", folder_ / "sdf", "--quiet"})
          .wait();
  ASSERT_EQ(exported.exit_code, 0) << exported.error;
  std::size_t worlds = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "sdf")) {
    if (entry.path().extension() != ".world") continue;
    const std::string text = read_text(entry.path());
    bool found = false;
    for (int number = 1; number <= 4; ++number)
      found |= text.find(fmt::format(
                   "<mu>{:.9g}<",
                   scene::read_scene_json(scene_path(number) + "/scene.json").drawn.at("physics.friction_tube"))) !=
               std::string::npos;
    EXPECT_TRUE(found) << entry.path();
    ++worlds;
  }
  EXPECT_EQ(worlds, 4u);
}

}  // namespace
}  // namespace tubebin::testing
