#include "export/formats.hpp"
#include "export/published_layout.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/scene/tubes_txt.hpp"

namespace tubebin::exports {
namespace {

cloud::Cloud tubes_alone(const cloud::Cloud& cloud) {
  cloud::Cloud tubes;
  tubes.world_from_sensor = cloud.world_from_sensor;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud::is_finite(cloud.points[i]) || cloud.labels[i] == 0) continue;
    tubes.points.push_back(cloud.points[i]);
    tubes.labels.push_back(cloud.labels[i]);
    if (!cloud.colors.empty()) tubes.colors.push_back(cloud.colors[i]);
  }
  tubes.width = static_cast<std::uint32_t>(tubes.size());
  return tubes;
}

class PlyFormat : public ExportFormat {
 public:
  std::string scene_path(const SceneEntry& entry) const override { return published_path(entry, "plys", ".ply"); }

  SceneFiles export_scene(const SceneToExport& scene) const override {
    return {.beside = {{published_path(scene.entry, "tube_configurations", ".txt"),
                        scene::format_tubes_txt(scene.record.scene.tubes)}},
            .scene = {{"", cloud::format_cloud(tubes_alone(scene.cloud), cloud::CloudFormat::ply_binary)}}};
  }
};

}  // namespace

std::unique_ptr<ExportFormat> ply_format() { return std::make_unique<PlyFormat>(); }

}  // namespace tubebin::exports
