#include "tubebin/results/cloud_files.hpp"

#include <algorithm>
#include <tuple>

#include "tubebin/core/error.hpp"
#include "tubebin/evaluation/run_score.hpp"

namespace tubebin::results {

std::vector<CloudFile> find_clouds(const scene::DatasetFiles& files) {
  std::vector<CloudFile> clouds;
  for (const std::string& scene : files.scenes()) clouds.push_back({scene, files.cloud_of(scene)});
  if (clouds.empty())
    throw_io_error("{}: holds no cloud.pcd or cloud.ply in any of its folders or packs", files.dataset());
  const auto key = [](const CloudFile& cloud) {
    const evaluation::RunKey name = evaluation::parse_scene_name(cloud.scene);
    return std::tuple(name.tubes, name.set, name.case_number, cloud.scene);
  };
  std::ranges::sort(clouds, {}, key);
  return clouds;
}

}  // namespace tubebin::results
