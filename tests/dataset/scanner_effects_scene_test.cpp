// Data sets of a scanner with all its effects.
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include "dataset/verify_scene.hpp"
#include "support/program.hpp"
#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::testing {

using namespace dataset;
namespace {

using ::testing::HasSubstr;

/// One quick scene, with effects if `include` names them.
std::string make_scene(const TemporaryFolder& folder, const std::string& name, const std::string& include) {
  const std::string config = folder / (name + ".yaml"), data = folder / name;
  write_text(config, include + quick_config());
  const ProgramResult result = run_generate_dataset({config, "--output", data, "--tubes", "3", "--cases", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  return data;
}

std::string effects() { return "include: " TUBEBIN_SOURCE_DIR "/config/scanner_zivid_like.yaml\n"; }
std::string exact() { return "include: " TUBEBIN_SOURCE_DIR "/config/set_a.yaml\n"; }

TEST(ScannerEffects, CleanTwinAndTubesAreThoseOfTheExactDataSet) {
  const TemporaryFolder folder;
  const std::string noisy = make_scene(folder, "noisy", effects()), clean = make_scene(folder, "clean", exact());
  auto files = scene_files(noisy), exact_files = scene_files(clean);
  EXPECT_EQ(files.at("Q3/001/cloud_clean.pcd"), exact_files.at("Q3/001/cloud.pcd"));
  EXPECT_EQ(files.at("Q3/001/tubes.txt"), exact_files.at("Q3/001/tubes.txt"));
  EXPECT_NE(files.at("Q3/001/cloud.pcd"), exact_files.at("Q3/001/cloud.pcd"));
  EXPECT_THAT(files.at("Q3/001/scene.json"), HasSubstr("\"effects\""));
  EXPECT_EQ(exact_files.at("Q3/001/scene.json").find("\"effects\""), std::string::npos);
  EXPECT_EQ(run_generate_dataset({"--verify", noisy}).exit_code, 0);
}

TEST(ScannerEffects, VerifyFindsAPointThatIsNotTheSeeds) {
  const TemporaryFolder folder;
  const std::string data = make_scene(folder, "noisy", effects());
  for (const std::string file : {"cloud.pcd", "cloud_clean.pcd"}) {
    const std::string path = data + "/Q3/001/" + file, sound = read_text(path);
    cloud::Cloud cloud = cloud::read_cloud(path);
    std::ranges::find_if(cloud.points, cloud::is_finite)->y() += 2e-5F;
    const std::string bytes = cloud::format_cloud(cloud, cloud::CloudFormat::pcd_binary);
    write_text(path, bytes);
    ManifestRecord record = *Manifest(data).find("Q3/001");
    record.files[file] = record_bytes(bytes);
    const auto problems = verify_scene(scene::DatasetFiles(data), read_dataset_config(data), {"Q", 3, 1}, record);
    EXPECT_THAT(fmt::format("{}", fmt::join(problems, "\n")), HasSubstr("1 points"));
    write_text(path, sound);
  }
}

}  // namespace
}  // namespace tubebin::testing
