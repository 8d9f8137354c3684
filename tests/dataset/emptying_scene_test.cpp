// Bins that are emptied tube by tube.
#include <algorithm>

#include "dataset/pile.hpp"
#include "dataset/shards.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::testing {

using namespace dataset;
namespace {

using ::testing::HasSubstr;

class Emptying : public Shards {
 protected:
  Emptying() {
    write_text(config_, "set: E\nseed: 5\ntubes: [3, 4]\ncases: 2\nsequence: {lifts: 3}\n");
    EXPECT_EQ(generate(emptied_).exit_code, 0);
    steps_ = scene_files(emptied_);
  }

  std::string emptied_ = folder_ / "emptied";
  std::map<std::string, std::string> steps_;
};

TEST_F(Emptying, EachStepIsASceneWithOneTubeLess) {
  const Manifest manifest(emptied_);
  EXPECT_EQ(manifest.records().size(), 2U * 3U + 2U * 4U) << "one tube stays";
  for (int step = 0; step < 4; ++step) {
    const std::string id = fmt::format("E4/002/step_{:02}", step);
    ASSERT_NE(manifest.find(id), nullptr) << id;
    EXPECT_EQ(manifest.find(id)->tubes, 4 - step);
    const scene::SceneRecord scene = scene::read_scene_json(emptied_ + "/" + id + "/scene.json");
    EXPECT_EQ(scene.scene.tubes.size(), static_cast<std::size_t>(4 - step));
    ASSERT_EQ(scene.lift.has_value(), step > 0);
    if (scene.lift) {
      EXPECT_GT(scene.lift->force, 0.99 * 0.055 * 9.81) << "a tube's weight";
    }
  }
  const ProgramResult verified = run_generate_dataset({"--verify", emptied_});
  EXPECT_EQ(verified.exit_code, 0) << verified.out;
  EXPECT_THAT(verified.out, HasSubstr("14 scenes checked, 0 damaged"));
}

TEST_F(Emptying, ShardsAndRunsThatGoOnMakeTheSameSteps) {
  for (const char* shard : {"1/2", "2/2"}) ASSERT_EQ(generate(data_, {"--shard", shard}).exit_code, 0);
  EXPECT_EQ(scene_files(data_), steps_);

  fs::remove_all(emptied_ + "/E3/001/step_01");
  EXPECT_THAT(generate(emptied_).error, HasSubstr("14 of 14 scenes are complete: 1 made"));
  EXPECT_EQ(scene_files(emptied_), steps_);
}

TEST_F(Emptying, PacksHoldSteps) {
  ASSERT_EQ(generate(data_, {"--pack"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(data_ + "/E4"));
  EXPECT_EQ(run_generate_dataset({"--verify", data_}).exit_code, 0);
}

TEST_F(Emptying, AStepThatDoesNotFollowFromTheOneBeforeIsDamaged) {
  Manifest manifest{OutputFolder(emptied_)};
  ManifestRecord record = *manifest.find("E4/001/step_02");
  const std::string path = emptied_ + "/E4/001/step_02/scene.json";
  std::string text = read_text(path);
  const std::size_t at = text.find("\"force\":");
  ASSERT_NE(at, std::string::npos);
  const std::size_t moved = text.find("\"moved\":[", at) + 9;
  text.insert(moved, text[moved] == ']' ? R"({"label":1,"distance":0.5})" : R"({"label":1,"distance":0.5},)");
  write_text(path, text);
  record.files["scene.json"] = record_bytes(text);
  manifest.append(record);
  EXPECT_THAT(run_generate_dataset({"--verify", emptied_}).out,
              HasSubstr("the tubes did not move from where E4/001/step_01 has them"));
}

int count_above(const std::vector<scene::PlacedTube>& tubes, std::size_t index) {
  return static_cast<int>(std::ranges::count(scene::find_above(tubes), index + 1, &scene::Above::lower));
}

TEST(EmptyingRule, LiftsOneOfTheTubesWithTheFewestAbove) {
  const DatasetConfig config = load_config(TUBEBIN_SOURCE_DIR "/config/set_a.yaml");
  const Piles made = make_piles(config, {"A", 12, 2}, 0, 6);
  ASSERT_EQ(made.failure, "") << made.failure_detail;
  for (std::size_t step = 1; step < made.piles.size(); ++step) {
    const std::vector<scene::PlacedTube>& before = made.piles[step - 1].rest.tubes;
    const scene::Lift& lift = made.piles[step].lift.value();
    if (!lift.given_up.empty()) continue;
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_LE(count_above(before, lift.lifted - 1), count_above(before, i)) << "step " << step;
  }
}

TEST(EmptyingRule, ALiftThatLeavesNoRestGivesWayToAnother) {
  DatasetConfig config = load_config(TUBEBIN_SOURCE_DIR "/config/set_a.yaml");
  config.physics.penetration_max = 0.000105;  // metres; hardly more than a resting contact has, or no lift would fail
  const Piles made = make_piles(config, {"A", 10, 4}, 0, 9);
  ASSERT_EQ(made.failure, "") << made.failure_detail;
  int given_up = 0;
  for (std::size_t step = 1; step < made.piles.size(); ++step) {
    Random random(made.piles[step].seed);
    for (const std::uint32_t label : made.piles[step].lift->given_up) {
      ++given_up;
      EXPECT_NE(label, made.piles[step].lift->lifted);
      const physics::LiftResult lift = physics::lift_tube(made.piles[step - 1].rest, label - 1, config.bin,
                                                          config.physics, config.sequence.lift, random.bits());
      EXPECT_NE(lift.rest.failure, physics::DropFailure::none) << "tube " << label << " of step " << step - 1;
    }
  }
  EXPECT_GT(given_up, 0) << "choose another pile for this test";
}

}  // namespace
}  // namespace tubebin::testing
