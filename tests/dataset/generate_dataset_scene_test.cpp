// The program as a user runs it, on a quick configuration.
#include <gmock/gmock.h>

#include "dataset/verify_scene.hpp"
#include "support/program.hpp"
#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/render/preview.hpp"
#include "tubebin/scene/scene_json.hpp"
#include "tubebin/scene/tubes_txt.hpp"

namespace tubebin::testing {

using namespace dataset;
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class GenerateDataset : public ::testing::Test {
 protected:
  GenerateDataset() { write_text(config_, quick_config()); }

  ProgramResult generate(const std::string& output, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {config_, "--output", output});
    return run_generate_dataset(more);
  }

  TemporaryFolder folder_;
  std::string config_ = folder_ / "quick.yaml";
  std::string data_ = folder_ / "data";
};

TEST_F(GenerateDataset, WritesWhatItPromises) {
  const ProgramResult result = generate(data_);
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_THAT(result.out, HasSubstr("tubes"));
  const Manifest manifest(data_);
  EXPECT_EQ(manifest.records().size(), 8u);
  for (const auto& [id, record] : manifest.records()) {
    EXPECT_EQ(record.files.size(), 3u);
    for (const auto& [name, file] : record.files)
      EXPECT_EQ(record_bytes(read_text(data_ + "/" + id + "/" + name.str())), file) << id << " " << name.str();
  }
  const scene::SceneRecord scene = scene::read_scene_json(data_ + "/Q3/002/scene.json");
  EXPECT_EQ(scene.id, "Q3/002");
  EXPECT_EQ(scene.scene.tubes.size(), 3u);
  EXPECT_EQ(scene::read_tubes_txt(data_ + "/Q3/002/tubes.txt").size(), 3u);
  const cloud::Cloud cloud = cloud::read_cloud(data_ + "/Q3/002/cloud.pcd");
  EXPECT_EQ(std::set<cloud::Label>(cloud.labels.begin(), cloud.labels.end()), (std::set<cloud::Label>{0, 1, 2, 3}));
}

TEST_F(GenerateDataset, MakesTheSameBytesForAnyJobsAndShards) {
  ASSERT_EQ(generate(data_, {"--jobs", "1"}).exit_code, 0);
  ASSERT_EQ(generate(folder_ / "two", {"--jobs", "2"}).exit_code, 0);
  ASSERT_EQ(generate(folder_ / "first", {"--shard", "1/2"}).exit_code, 0);
  ASSERT_EQ(generate(folder_ / "second", {"--shard", "2/2"}).exit_code, 0);
  const auto files = scene_files(data_);
  EXPECT_EQ(files.size(), 24u);
  EXPECT_EQ(scene_files(folder_ / "two"), files);
  auto both = scene_files(folder_ / "first");
  const std::size_t first = both.size();
  both.merge(scene_files(folder_ / "second"));
  EXPECT_EQ(first, 12u);
  EXPECT_EQ(both, files);
}

TEST_F(GenerateDataset, MakesTheSameFromTheConfigurationInTheDataSet) {
  ASSERT_EQ(generate(data_, {"--seed", "77", "--tubes", "2", "--cases", "2"}).exit_code, 0);
  const std::string again = folder_ / "again";
  ASSERT_EQ(run_generate_dataset({data_ + "/config.yaml", "--output", again}).exit_code, 0);
  EXPECT_EQ(scene_files(again), scene_files(data_));
}

TEST_F(GenerateDataset, OtherSeedsMakeOtherScenes) {
  ASSERT_EQ(generate(data_, {"--cases", "1"}).exit_code, 0);
  ASSERT_EQ(generate(folder_ / "other", {"--cases", "1", "--seed", "6"}).exit_code, 0);
  auto other = scene_files(folder_ / "other");
  for (const auto& [name, bytes] : scene_files(data_)) EXPECT_NE(other[name], bytes) << name;
}

TEST_F(GenerateDataset, KeepsCompleteScenesAndAddsMore) {
  ASSERT_EQ(generate(data_, {"--tubes", "1", "--cases", "2"}).exit_code, 0);
  const auto before = fs::last_write_time(data_ + "/Q1/001/cloud.pcd");
  const ProgramResult result = generate(data_);
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_THAT(result.error, HasSubstr("6 made"));
  EXPECT_EQ(fs::last_write_time(data_ + "/Q1/001/cloud.pcd"), before);
  EXPECT_EQ(Manifest(data_).records().size(), 8u);
}

TEST_F(GenerateDataset, RefusesAnOutputOfAnotherConfigurationOrSeed) {
  ASSERT_EQ(generate(data_, {"--tubes", "1", "--cases", "1"}).exit_code, 0);
  const auto files = scene_files(data_);
  const ProgramResult other_seed = generate(data_, {"--seed", "6"});
  EXPECT_EQ(other_seed.exit_code, 2);
  EXPECT_THAT(other_seed.error, AllOf(HasSubstr(data_), HasSubstr("seed: 5 there, 6 here")));
  write_text(config_, quick_config() + "bin: {length: 0.6}\n");
  const ProgramResult other_bin = generate(data_);
  EXPECT_EQ(other_bin.exit_code, 2);
  EXPECT_THAT(other_bin.error, HasSubstr("bin.length: 0.55 there, 0.6 here"));
  EXPECT_EQ(scene_files(data_), files);
}

TEST_F(GenerateDataset, RefusesAFolderThatIsNoDataSet) {
  fs::create_directory(data_);
  write_text(data_ + "/thesis.txt", "mine");
  EXPECT_EQ(generate(data_).exit_code, 2);
  EXPECT_EQ(run_generate_dataset({"--verify", data_}).exit_code, 1);
  EXPECT_EQ(std::distance(fs::directory_iterator(data_), {}), 2);  // and the lock
}

TEST_F(GenerateDataset, NamesAnOutputThatCannotBeMade) {
  for (const std::string& output : {config_ + "/data", std::string("/proc/data"), config_}) {
    const ProgramResult result = generate(output);
    EXPECT_EQ(result.exit_code, 1) << output;
    EXPECT_THAT(result.error, HasSubstr(output));
  }
}

TEST_F(GenerateDataset, RefusesWrongUsage) {
  EXPECT_EQ(run_generate_dataset({}).exit_code, 2);
  EXPECT_EQ(run_generate_dataset({config_}).exit_code, 2);
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{{"--tubes", "1-x"},
                                                                                     {"--cases", "0"},
                                                                                     {"--shard", "0/2"},
                                                                                     {"--jobs", "0"},
                                                                                     {"--seed", "-1"},
                                                                                     {"--repair"},
                                                                                     {"--no-such-option"}}) {
    EXPECT_EQ(generate(data_, wrong).exit_code, 2) << wrong[0];
    EXPECT_FALSE(fs::exists(data_)) << wrong[0];
  }
  EXPECT_EQ(run_generate_dataset({"--help"}).exit_code, 0);
  EXPECT_EQ(run_generate_dataset({"--version"}).exit_code, 0);
}

TEST_F(GenerateDataset, NamesScenesThatCannotBeDone) {
  write_text(config_, quick_config() + "attempts_max: 2\nphysics: {drift_max: 0.0, time_limit: 3.0}\n");
  const ProgramResult result = generate(data_, {"--tubes", "3", "--cases", "2"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.error,
              AllOf(HasSubstr("Q3/001: given up after 2 attempts"), HasSubstr("Q3/002: given up after 2 attempts")));
  EXPECT_TRUE(scene_files(data_).empty());
}

TEST_F(GenerateDataset, QuietPrintsTheTableAlone) {
  const ProgramResult result = generate(data_, {"--cases", "1", "--quiet"});
  EXPECT_EQ(result.error, "");
  EXPECT_THAT(result.out, HasSubstr("Table 1"));
}

TEST_F(GenerateDataset, WritesEveryFormatSoThatItVerifies) {
  for (const std::string format : {"pcd_binary", "pcd_compressed", "pcd_ascii", "ply_binary"})
    for (const std::string region : {"bin", "full", "tubes"}) {
      write_text(config_, "tubes: [2]\ncases: 1\noutput: {format: " + format +
                              "}\nscanner: {width: 160, height: 100, region: " + region + "}\n");
      const std::string data = folder_ / (format + "_" + region);
      ASSERT_EQ(generate(data).exit_code, 0);
      const ProgramResult verified = run_generate_dataset({"--verify", data});
      EXPECT_EQ(verified.exit_code, 0) << format << " " << region << ": " << verified.out;
    }
}

TEST_F(GenerateDataset, DrawsPreviewsThatNeitherChangeNorDependOnTheRest) {
  if (!render::can_render()) GTEST_SKIP() << "this build cannot draw";
  ASSERT_EQ(generate(data_, {"--cases", "2"}).exit_code, 0);
  ASSERT_EQ(generate(folder_ / "one", {"--cases", "2", "--preview", "--jobs", "1"}).exit_code, 0);
  ASSERT_EQ(generate(folder_ / "two", {"--cases", "2", "--preview", "--jobs", "2"}).exit_code, 0);
  auto with_pictures = scene_files(folder_ / "one");
  EXPECT_EQ(scene_files(folder_ / "two"), with_pictures);
  for (const std::string scene : {"Q1/001", "Q1/002", "Q3/001", "Q3/002"})
    for (const std::string picture : {"/preview.png", "/ground_truth.png"}) {
      const auto png = with_pictures.extract(scene + picture);
      ASSERT_FALSE(png.empty()) << scene << picture;
      EXPECT_TRUE(png.mapped().starts_with("\x89PNG")) << scene << picture;
    }
  EXPECT_EQ(with_pictures, scene_files(data_));
  const Manifest manifest(folder_ / "one");
  for (const auto& [id, record] : manifest.records()) EXPECT_GT(record.seconds.at("preview"), 0.0);
}

TEST_F(GenerateDataset, SaysWhyATubeDoesNotFit) {
  write_text(config_, "tubes: [1]\ncases: 1\nattempts_max: 2\nbin: {length: 0.02, width: 0.02}\n");
  const ProgramResult result = generate(data_);
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.error, HasSubstr("A1/001: given up after 2 attempts (2 spawn); last: a tube fits"));
}

class Verify : public GenerateDataset {
 protected:
  Verify() {
    EXPECT_EQ(generate(data_, {"--cases", "3"}).exit_code, 0);
    files_ = scene_files(data_);
  }

  /// Says that the scene is damaged, and makes it and the manifest right again.
  void expect_found_and_repaired(const std::string& scene) {
    const ProgramResult found = run_generate_dataset({"--verify", data_, "--quiet"});
    EXPECT_EQ(found.exit_code, 3);
    EXPECT_THAT(found.out, AllOf(HasSubstr(scene + ": "), HasSubstr("1 damaged")));
    const ProgramResult repaired = run_generate_dataset({"--verify", data_, "--repair"});
    EXPECT_EQ(repaired.exit_code, 0) << repaired.error;
    EXPECT_EQ(scene_files(data_), files_);
    EXPECT_EQ(run_generate_dataset({"--verify", data_}).exit_code, 0);
    EXPECT_EQ(Manifest(data_).records().size(), 6u);
  }

  std::map<std::string, std::string> files_;
};

TEST_F(Verify, FindsAByteThatFlipped) {
  const std::string path = data_ + "/Q3/002/cloud.pcd";
  std::string bytes = read_text(path);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_text(path, bytes);
  expect_found_and_repaired("Q3/002");
}

TEST_F(Verify, FindsACutOrMissingFile) {
  fs::resize_file(data_ + "/Q1/001/scene.json", 100);
  expect_found_and_repaired("Q1/001");
  fs::remove(data_ + "/Q1/003/tubes.txt");
  expect_found_and_repaired("Q1/003");
}

TEST_F(Verify, FindsAMissingSceneAndALostRecord) {
  fs::remove_all(data_ + "/Q3/003");
  expect_found_and_repaired("Q3/003");
  std::string manifest = read_text(data_ + "/manifest.jsonl");
  const std::size_t id = manifest.find("Q1/002");
  manifest[id] = '"';
  write_text(data_ + "/manifest.jsonl", manifest);
  expect_found_and_repaired("Q1/002");
}

TEST_F(Verify, CountsWhatWasNeverMade) {
  fs::remove_all(data_ + "/Q3/003");
  DatasetConfig config = read_dataset_config(data_);
  DatasetFolder(data_, config).manifest().rewrite_without({"Q3/003"});
  const ProgramResult result = run_generate_dataset({"--verify", data_});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("5 scenes checked, 0 damaged, 1 not generated yet"));
}

/// Content that contradicts itself is found although hash and size are as recorded.
class VerifyScene : public Verify {
 protected:
  /// The problems of the scene after `path` was given other bytes, and the manifest their hash.
  std::string problems_with(const std::string& file, const std::string& bytes) {
    ManifestRecord record = *Manifest(data_).find("Q3/001");
    write_text(data_ + "/Q3/001/" + file, bytes);
    record.files[file] = record_bytes(bytes);
    return fmt::format(
        "{}",
        fmt::join(verify_scene(scene::DatasetFiles(data_), read_dataset_config(data_), {"Q", 3, 1}, record), "\n"));
  }
  std::string problems_with(const cloud::Cloud& cloud) {
    return problems_with("cloud.pcd", cloud::format_cloud(cloud, cloud::CloudFormat::pcd_binary));
  }
  std::string problems_with(const scene::SceneRecord& scene) {
    return problems_with("scene.json", scene::format_scene_json(scene));
  }

  cloud::Cloud cloud() { return cloud::read_cloud(data_ + "/Q3/001/cloud.pcd"); }
  scene::SceneRecord scene() { return scene::read_scene_json(data_ + "/Q3/001/scene.json"); }
  std::size_t tube_point(const cloud::Cloud& cloud) {
    return static_cast<std::size_t>(std::find(cloud.labels.begin(), cloud.labels.end(), 2u) - cloud.labels.begin());
  }
};

TEST_F(VerifyScene, AcceptsASoundScene) { EXPECT_EQ(problems_with(cloud()), ""); }

TEST_F(VerifyScene, FindsAPointOffItsSurface) {
  cloud::Cloud moved = cloud();
  moved.points[tube_point(moved)].z() += 2e-5f;
  EXPECT_THAT(problems_with(moved), HasSubstr("1 points lie more than 0.005 mm off the surface"));
}

TEST_F(VerifyScene, FindsWrongLabelsAndColors) {
  cloud::Cloud relabelled = cloud();
  relabelled.labels[tube_point(relabelled)] = 1;
  EXPECT_THAT(problems_with(relabelled), AllOf(HasSubstr("1 points lie"), HasSubstr("1 points have another colour"),
                                               HasSubstr("pixels of the tubes")));
  cloud::Cloud unknown = cloud();
  unknown.labels[tube_point(unknown)] = 4;
  EXPECT_THAT(problems_with(unknown), HasSubstr("1 points have labels of no tube"));
}

TEST_F(VerifyScene, FindsACloudOfAnotherSize) {
  cloud::Cloud flat = cloud();
  flat.width = static_cast<std::uint32_t>(flat.size());
  flat.height = 1;
  EXPECT_THAT(problems_with(flat), HasSubstr("the window of scene.json"));
}

TEST_F(VerifyScene, FindsAnotherScenesTruth) {
  EXPECT_THAT(problems_with("scene.json", read_text(data_ + "/Q3/002/scene.json")),
              AllOf(HasSubstr("calls itself Q3/002"), HasSubstr("seed")));
  EXPECT_NE(problems_with("tubes.txt", read_text(data_ + "/Q3/002/tubes.txt")), "");
}

TEST_F(VerifyScene, FindsColorsThatAreNotUnique) {
  scene::SceneRecord same = scene();
  same.colors[2] = same.colors[1];
  EXPECT_THAT(problems_with(same), HasSubstr("3 different colours for 3 tubes and the bin"));
}

TEST_F(VerifyScene, FindsTubesThatInterpenetrateOrFloat) {
  scene::SceneRecord deep = scene();
  deep.contacts.at(0).depth = 0.0012;
  EXPECT_THAT(problems_with(deep), HasSubstr("interpenetrate by 1.200 mm, more than the 0.500 mm allowed"));
  scene::SceneRecord floating = scene();
  floating.contacts.clear();
  EXPECT_THAT(problems_with(floating), HasSubstr("tube 3 floats"));
}

}  // namespace
}  // namespace tubebin::testing
