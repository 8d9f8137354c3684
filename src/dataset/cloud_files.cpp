#include "tubebin/dataset/cloud_files.hpp"

#include <algorithm>
#include <filesystem>
#include <tuple>

#include "tubebin/core/error.hpp"
#include "tubebin/evaluation/run_score.hpp"

namespace tubebin {

namespace fs = std::filesystem;

std::vector<CloudFile> find_clouds(const std::string& dataset) try {
  std::vector<CloudFile> clouds;
  for (const auto& entry : fs::recursive_directory_iterator(dataset)) {
    const fs::path& path = entry.path();
    const fs::path scene = fs::relative(path.parent_path(), dataset);
    const bool is_hidden = scene.filename().string().starts_with('.') && scene != ".";
    if ((path.filename() == "cloud.pcd" || path.filename() == "cloud.ply") && !is_hidden)
      clouds.push_back({scene.string(), path.string()});
  }
  if (clouds.empty()) throw_io_error("{}: holds no cloud.pcd or cloud.ply in any of its folders", dataset);
  const auto key = [](const CloudFile& cloud) {
    const RunKey name = parse_scene_name(cloud.scene);
    return std::tuple(name.tubes, name.set, name.case_number, cloud.scene);
  };
  std::ranges::sort(clouds, {}, key);
  return clouds;
} catch (const fs::filesystem_error& error) {
  throw_io_error("{}: cannot be searched for clouds: {}", dataset, error.code().message());
}

}  // namespace tubebin
