// Do our piles look like the published ones? piles_table PUBLISHED RESCANNED DATASET...
// PUBLISHED holds the published data set's files (A10_1.txt: set A, ten tubes, case 1). They are scanned with
// the published scanner into the data set RESCANNED, for model_tubes and evaluate; the Markdown table
// compares their piles with those of the DATASETs. Branching tubes (set C) are scanned too; no data set of
// ours has them.
#include <algorithm>
#include <filesystem>
#include <map>

#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/evaluation/pile_statistics.hpp"
#include "tubebin/evaluation/run_score.hpp"
#include "tubebin/scan/scanner.hpp"
#include "tubebin/scene/scene_json.hpp"
#include "tubebin/scene/tubes_txt.hpp"

namespace {

using namespace tubebin;
namespace fs = std::filesystem;

/// What the published .world files say of bin and scanner.
scene::Scene published_scene(const std::string& path) {
  scene::Scene scene;
  scene.bin = {.length = 0.80, .width = 0.60, .height = 0.20, .wall_thickness = 0.02};
  scene.scanner.range_max = 2.0;
  scene.tubes = scene::read_tubes_txt(path);
  return scene;
}

/// "A10_2" -> "A10/002".
std::string scene_name(const std::string& stem) {
  const std::size_t underscore = stem.find('_');
  if (underscore == std::string::npos) throw_io_error("{}.txt: expected a name such as A10_2.txt", stem);
  return fmt::format("{}/{:0>3}", stem.substr(0, underscore), stem.substr(underscore + 1));
}

scene::SceneRecord rescan(const fs::path& file, const std::string& dataset) {
  scene::SceneRecord record;
  record.id = scene_name(file.stem().string());
  record.scene = published_scene(file.string());
  const scan::Scan scanned = scan::scan(record.scene);
  record.window = scanned.window;
  record.tube_pixels = scanned.tube_pixels;
  record.colors = cloud::label_colors(record.scene.tubes.size());
  const std::string folder = dataset + "/" + record.id;
  fs::create_directories(folder);
  cloud::write_cloud(folder + "/cloud.pcd", scanned.cloud, cloud::CloudFormat::pcd_compressed);
  write_file_atomically(folder + "/scene.json", scene::format_scene_json(record));
  return record;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4) throw_config_error("usage: piles_table PUBLISHED RESCANNED DATASET...");
  std::map<std::pair<std::string, int>, evaluation::PileComparison> comparisons;
  const auto comparison = [&](const std::string& id) -> evaluation::PileComparison& {
    const evaluation::RunKey key = evaluation::parse_scene_name(id);
    evaluation::PileComparison& found = comparisons[{key.set, key.tubes}];
    found.name = fmt::format("{}{}", key.set, key.tubes);
    return found;
  };
  for (const auto& entry : fs::directory_iterator(argv[1])) {
    if (entry.path().extension() != ".txt") continue;
    const scene::SceneRecord record = rescan(entry.path(), argv[2]);
    comparison(record.id).published.push_back(evaluation::pile_statistics(record.scene, record.tube_pixels));
  }
  for (int i = 3; i < argc; ++i) {
    const dataset::Manifest manifest(argv[i]);
    for (const auto& [id, unused] : manifest.records()) {
      const scene::SceneRecord record = scene::read_scene_json(fmt::format("{}/{}/scene.json", argv[i], id));
      comparison(id).here.push_back(evaluation::pile_statistics(record.scene, record.tube_pixels));
    }
  }
  std::vector<evaluation::PileComparison> list;
  for (const auto& [key, value] : comparisons) list.push_back(value);
  fmt::print("{}", evaluation::format_markdown(evaluation::pile_table(list)));
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "piles_table: {}\n", error.what());
  return 1;
}
