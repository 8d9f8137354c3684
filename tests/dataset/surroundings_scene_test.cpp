// What stands around the bin, from the configuration to a verified data set.
#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "support/commands.hpp"
#include "support/faults.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::testing {

using namespace dataset;
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kPlain =
    "set: S\nseed: 5\ntubes: [3]\ncases: 2\n"
    "scanner: {position: [0, -0.8, 1.4], rotation_deg: [30, 0, 0], width: 320, height: 240, region: full}\n";
const std::string kCell = kPlain +
                          "surroundings: {table: {length: 1.9, width: 1.5}, boxes: {count_min: 1, count_max: 3}, "
                          "cylinders: {count_min: 1, count_max: 3}, bins: 1}\n";

class Surroundings : public ::testing::Test {
 protected:
  static ProgramResult make(const std::string& config, const std::string& data) {
    write_text(data + ".yaml", config);
    return run_generate_dataset({data + ".yaml", "--output", data, "--jobs", "2"});
  }
  void make_cells(const std::string& more = "") {
    const ProgramResult made = make(kCell + more, data_);
    ASSERT_EQ(made.exit_code, 0) << made.error;
  }
  scene::SceneRecord scene(const std::string& id) { return scene::read_scene_json(data_ + "/" + id + "/scene.json"); }
  std::string verify() { return run_generate_dataset({"--verify", data_}).out; }

  TemporaryFolder folder_;
  std::string data_ = folder_ / "data";
};

TEST_F(Surroundings, TheShippedCellIsMadeAndVerified) {
  const ProgramResult made =
      run_generate_dataset({TUBEBIN_SOURCE_DIR "/config/cell.yaml", "--output", data_, "--tubes", "3", "--cases", "1"});
  ASSERT_EQ(made.exit_code, 0) << made.error;
  EXPECT_THAT(verify(), HasSubstr("1 scenes checked, 0 damaged"));
  expect_schema("scene.schema.json", data_ + "/cell3/001/scene.json");
  const scene::SceneRecord record = scene("cell3/001");
  ASSERT_TRUE(record.scene.surroundings);
  EXPECT_EQ(record.scene.surroundings->bins.size(), 1u);
  EXPECT_FALSE(record.scene.surroundings->boxes.empty());
  EXPECT_FALSE(record.scene.surroundings->cylinders.empty());

  const cloud::Cloud cloud = cloud::read_cloud(data_ + "/cell3/001/cloud.pcd");
  EXPECT_EQ(cloud.size(), static_cast<std::size_t>(record.scene.scanner.width * record.scene.scanner.height));
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    beyond += cloud::is_finite(cloud.points[i]) && std::abs(cloud.points[i].x()) > 0.4F && cloud.labels[i] == 0;
  EXPECT_GT(beyond, cloud.size() / 10) << "the table, and what stands on it";
}

TEST_F(Surroundings, ChangeNeitherThePileNorItsSeed) {
  make_cells();
  const std::string plain = folder_ / "plain";
  ASSERT_EQ(make(kPlain, plain).exit_code, 0);
  for (const std::string id : {"S3/001", "S3/002"}) {
    EXPECT_EQ(read_text(data_ + "/" + id + "/tubes.txt"), read_text(plain + "/" + id + "/tubes.txt"));
    EXPECT_EQ(scene(id).seed, scene::read_scene_json(plain + "/" + id + "/scene.json").seed);
  }
  EXPECT_NE(scene("S3/001").scene.surroundings, scene("S3/002").scene.surroundings);
}

TEST_F(Surroundings, AreTheSameBytesAgain) {
  make_cells();
  const std::string again = folder_ / "again";
  ASSERT_EQ(make(kCell, again).exit_code, 0);
  EXPECT_EQ(scene_files(again), scene_files(data_));
}

TEST_F(Surroundings, StayWhileTheBinIsEmptied) {
  make_cells("sequence: {lifts: 2}\n");
  for (int step = 1; step <= 2; ++step)
    EXPECT_EQ(scene(fmt::format("S3/001/step_{:02}", step)).scene.surroundings,
              scene("S3/001/step_00").scene.surroundings);
  EXPECT_THAT(verify(), HasSubstr("6 scenes checked, 0 damaged"));
}

TEST_F(Surroundings, VerifyFindsAnObjectThatIsNotTheSeeds) {
  make_cells();
  scene::SceneRecord moved = scene("S3/001");
  moved.scene.surroundings->cylinders.at(0).position.x() += 0.01;
  Manifest manifest{OutputFolder(data_)};
  ManifestRecord record = *manifest.find("S3/001");
  const std::string text = scene::format_scene_json(moved);
  write_text(data_ + "/S3/001/scene.json", text);
  record.files["scene.json"] = record_bytes(text);
  manifest.append(record);
  EXPECT_THAT(verify(), HasSubstr("other surroundings than config.yaml and the seed give"));
}

TEST_F(Surroundings, NumbersAreDrawnForEachPileRecordedAndVerified) {
  const ProgramResult made =
      make(kPlain +
               "surroundings: {table: {length: {uniform: [1.5, 2.5]}, width: 1.5}, boxes: {count_min: 2, count_max: 2, "
               "size_max: {choice: [0.06, 0.1]}}, cylinders: {count_max: {choice: [1, 2]}}, "
               "clearance: {uniform: [0.1, 0.2]}}\n",
           data_);
  ASSERT_EQ(made.exit_code, 0) << made.error;
  EXPECT_THAT(verify(), HasSubstr("2 scenes checked, 0 damaged"));
  std::set<double> lengths;
  for (const char* id : {"S3/001", "S3/002"}) {
    const scene::SceneRecord record = scene(id);
    const scene::Surroundings& around = record.scene.surroundings.value();
    EXPECT_EQ(around.table.size.x(), record.drawn.at("surroundings.table.length"));
    EXPECT_LE(around.cylinders.size(), record.drawn.at("surroundings.cylinders.count_max"));
    lengths.insert(around.table.size.x());
    for (const scene::StandingBox& box : around.boxes)
      EXPECT_LE(box.size.maxCoeff(), record.drawn.at("surroundings.boxes.size_max"));
    const double clearance = record.drawn.at("surroundings.clearance");
    for (const scene::StandingCylinder& cylinder : around.cylinders)
      for (const scene::StandingBox& box : around.boxes)
        EXPECT_GT((cylinder.position - box.position).norm() - cylinder.radius, clearance) << "to a point of the box";
  }
  EXPECT_EQ(lengths.size(), 2u);

  scene::SceneRecord other = scene("S3/001");
  other.drawn.at("surroundings.table.length") += 0.1;
  Manifest manifest{OutputFolder(data_)};
  ManifestRecord record = *manifest.find("S3/001");
  const std::string text = scene::format_scene_json(other);
  write_text(data_ + "/S3/001/scene.json", text);
  record.files["scene.json"] = record_bytes(text);
  manifest.append(record);
  EXPECT_THAT(verify(), HasSubstr("1 damaged"));
}

TEST_F(Surroundings, ATableWithoutRoomIsNamed) {
  const ProgramResult made = make(
      "set: S\nseed: 5\ntubes: [1]\ncases: 1\nattempts_max: 2\n"
      "surroundings: {table: {length: 0.7, width: 0.5}, boxes: {count_min: 2, count_max: 2}}\n",
      data_);
  EXPECT_EQ(made.exit_code, 3);
  EXPECT_THAT(made.error, AllOf(HasSubstr("2 crowded"), HasSubstr("box 1 found no free place on the table")));
}

}  // namespace
}  // namespace tubebin::testing
