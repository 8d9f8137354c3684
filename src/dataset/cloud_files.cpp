#include "tubebin/dataset/cloud_files.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <tuple>

#include "tubebin/core/error.hpp"

namespace tubebin {

namespace fs = std::filesystem;

SceneName parse_scene_name(const std::string& scene) {
  const std::size_t slash = scene.find('/');
  const std::string first = scene.substr(0, slash);
  const std::size_t digits = first.find_last_not_of("0123456789") + 1;
  SceneName name{.set = first};
  if (slash == std::string::npos || digits == 0 || digits == first.size()) return name;
  const std::string rest = scene.substr(slash + 1);
  int case_number = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), case_number);
  std::size_t tubes = 0;
  const auto [tubes_end, tubes_error] = std::from_chars(first.data() + digits, first.data() + first.size(), tubes);
  if (error != std::errc{} || end != rest.data() + rest.size() || tubes_error != std::errc{}) return name;
  return {first.substr(0, digits), tubes, case_number};
}

std::vector<CloudFile> find_clouds(const std::string& dataset) try {
  std::vector<CloudFile> clouds;
  for (const auto& entry : fs::recursive_directory_iterator(dataset)) {
    const fs::path path = entry.path();
    const fs::path scene = fs::relative(path.parent_path(), dataset);
    const bool is_hidden = scene.filename().string().starts_with('.') && scene != ".";
    if ((path.filename() == "cloud.pcd" || path.filename() == "cloud.ply") && !is_hidden)
      clouds.push_back({scene.string(), path.string()});
  }
  if (clouds.empty()) throw_io_error("{}: holds no cloud.pcd or cloud.ply in any of its folders", dataset);
  const auto key = [](const CloudFile& cloud) {
    const SceneName name = parse_scene_name(cloud.scene);
    return std::tuple(name.tubes, name.set, name.case_number, cloud.scene);
  };
  std::ranges::sort(clouds, {}, key);
  return clouds;
} catch (const fs::filesystem_error& error) {
  throw_io_error("{}: cannot be searched for clouds: {}", dataset, error.code().message());
}

}  // namespace tubebin
