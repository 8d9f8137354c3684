// Twenty thousand scenes of one tube: their names, and a manifest that holds them all.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "support/program.hpp"
#include "tubebin/dataset/generate_scene.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/dataset/scene_id.hpp"

namespace tubebin::dataset {
namespace {

constexpr int kScenes = 20'000;

DatasetConfig many_scenes() {
  DatasetConfig config;
  config.tubes = {1};
  config.cases = kScenes;
  return config;
}

TEST(ManyScenes, HaveNamesAndSeedsOfTheirOwn) {
  const DatasetConfig config = many_scenes();
  std::set<std::string> names;
  std::set<std::uint64_t> seeds;
  for (const SceneId& id : list_scenes(config)) {
    names.insert(id.name());
    seeds.insert(attempt_seed(config, id, 0));
  }
  EXPECT_EQ(names.size(), std::size_t{kScenes});
  EXPECT_EQ(seeds.size(), std::size_t{kScenes});
  EXPECT_TRUE(names.contains("A1/001"));
  EXPECT_TRUE(names.contains("A1/999"));
  EXPECT_TRUE(names.contains("A1/20000/20000"));
  std::map<std::string, int> entries;
  for (const std::string& name : names) ++entries[name.substr(0, name.rfind('/'))];
  for (const auto& [folder, count] : entries) EXPECT_LE(count, 1000) << folder;
}

TEST(ManyScenes, AreDealtToShardsWithoutLoss) {
  std::set<SceneId> all;
  for (int shard = 1; shard <= 7; ++shard)
    for (const SceneId& id : list_scenes(many_scenes(), {.index = shard, .count = 7}))
      EXPECT_TRUE(all.insert(id).second);
  EXPECT_EQ(all.size(), std::size_t{kScenes});
}

TEST(ManyScenes, AreAllFoundInTheManifest) {
  const testing::TemporaryFolder folder;
  const std::vector<SceneId> scenes = list_scenes(many_scenes());
  std::string lines;
  for (const SceneId& id : scenes) {
    const ManifestRecord record{.id = id.name(),
                                .tubes = 1,
                                .seed = static_cast<std::uint64_t>(id.case_number),
                                .rejected = {},
                                .seconds = {{"total", 0.01}},
                                .physics = {},
                                .files = {{"cloud.pcd", {.bytes = 1, .xxh128 = std::string(32, '0')}}}};
    lines += format_manifest_record(record) + "\n";
  }
  testing::write_text(folder / "manifest.jsonl", lines);
  const Manifest manifest(folder / "");
  EXPECT_EQ(manifest.records().size(), std::size_t{kScenes});
  EXPECT_TRUE(manifest.damaged_lines().empty());
  for (const SceneId& id : scenes) {
    const ManifestRecord* record = manifest.find(id.name());
    ASSERT_NE(record, nullptr) << id.name();
    EXPECT_EQ(record->seed, static_cast<std::uint64_t>(id.case_number));
  }
}

}  // namespace
}  // namespace tubebin::dataset
