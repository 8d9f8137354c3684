#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json_reader.hpp"
#include "export/formats.hpp"
#include "export/scene_image.hpp"
#include "export/tube_mesh_file.hpp"
#include "tubebin/core/atomic_file.hpp"

namespace tubebin::exports {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMillimetres = 1000.0;
/// The share of a tube that must be visible to be a target: as in the BOP challenge.
constexpr double kTargetVisibility = 0.1;
constexpr const char* kModelsInfo = "models_info.json";
constexpr const char* kGroundTruth = "scene_gt.json";
constexpr const char* kGroundTruthInfo = "scene_gt_info.json";
constexpr const char* kSceneCamera = "scene_camera.json";

std::string text_of(const Json& json) { return json.dump(1) + "\n"; }

Json rows_of(const Eigen::Matrix3d& matrix) {
  Json rows = Json::array();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) rows.push_back(matrix(row, column));
  return rows;
}

Json millimetres(const Vec3& vector) {
  return {kMillimetres * vector.x(), kMillimetres * vector.y(), kMillimetres * vector.z()};
}

Json box_json(const PixelBox& box) { return {box.x, box.y, box.width, box.height}; }

/// Millimetres a unit of the depth image: the finest power of ten by which 16 bits hold the scanner's range.
double depth_scale(const scene::Scanner& scanner) {
  double scale = 0.1;
  while (scanner.range_max * kMillimetres / scale > 65535.0) scale *= 10.0;
  return scale;
}

/// BOP's pixels have their centres at whole numbers, ours half a pixel farther.
Eigen::Matrix3d intrinsics(const scene::Camera& camera) {
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
  k(0, 0) = k(1, 1) = camera.focal_length();
  k(0, 2) = camera.width() / 2.0 - 0.5;
  k(1, 2) = camera.height() / 2.0 - 0.5;
  return k;
}

Raster<std::uint16_t> depth_image(const Raster<float>& depths, double scale) {
  Raster<std::uint16_t> image(depths.width, depths.height, 0);
  for (std::size_t i = 0; i < depths.values.size(); ++i)
    image.values[i] =
        static_cast<std::uint16_t>(std::lround(static_cast<double>(depths.values[i]) * kMillimetres / scale));
  return image;
}

Json camera_json(const scene::Camera& camera, double scale) {
  const Pose scanner_from_world = camera.world_from_scanner().inverse();
  return {{"0",
           {{"cam_K", rows_of(intrinsics(camera))},
            {"cam_R_w2c", rows_of(scanner_from_world.linear())},
            {"cam_t_w2c", millimetres(scanner_from_world.translation())},
            {"depth_scale", scale}}}};
}

Json pose_json(const scene::PlacedTube& placed, const scene::Camera& camera, int object) {
  const Pose scanner_from_tube = camera.world_from_scanner().inverse() * placed.world_from_tube;
  return {{"obj_id", object},
          {"cam_R_m2c", rows_of(scanner_from_tube.linear())},
          {"cam_t_m2c", millimetres(scanner_from_tube.translation())}};
}

Json info_json(const Mask& whole, const Mask& visible, const Raster<float>& depths) {
  std::size_t valid = 0;
  for (std::size_t i = 0; i < whole.values.size(); ++i) valid += whole.values[i] != 0 && depths.values[i] > 0.0F;
  const std::size_t all = pixels_of(whole), seen = pixels_of(visible);
  return {{"bbox_obj", box_json(box_of(whole))},
          {"bbox_visib", box_json(box_of(visible))},
          {"px_count_all", all},
          {"px_count_valid", valid},
          {"px_count_visib", seen},
          {"visib_fract", all > 0 ? static_cast<double>(seen) / static_cast<double>(all) : 0.0}};
}

Json model_json(const TubeMeshFile& mesh) {
  const Vec3 low = mesh.bounds_mm.min(), size = mesh.bounds_mm.sizes();
  return {{"diameter", mesh.diameter_mm}, {"min_x", low.x()},   {"min_y", low.y()},  {"min_z", low.z()},
          {"size_x", size.x()},           {"size_y", size.y()}, {"size_z", size.z()}};
}

class BopFormat : public ExportFormat {
 public:
  std::string scene_path(const SceneEntry& entry) const override { return fmt::format("test/{:06d}", entry.number); }

  SceneFiles export_scene(const SceneToExport& scene) const override {
    const SceneImage image(scene);
    const scene::Camera& camera = image.camera();
    const double scale = depth_scale(scene.record.scene.scanner);
    const Raster<float> depths = image.depths();
    const auto views = scan::view_tubes_alone(scene.record.scene);
    SceneFiles files;
    Json poses = Json::array(), infos = Json::array(), models = Json::object();
    for (std::size_t k = 0; k < views.size(); ++k) {
      const scene::PlacedTube& placed = scene.record.scene.tubes[k];
      const int object = scene.entry.first_object + static_cast<int>(k);
      const TubeMeshFile mesh = tube_mesh_file(placed.tube);
      const Mask whole = mask_of(views[k], camera), visible = image.visible_mask(static_cast<cloud::Label>(k + 1));
      files.beside[fmt::format("models/obj_{:06d}.ply", object)] = mesh.ply;
      files.scene[fmt::format("mask/000000_{:06d}.png", k)] = png_of(whole);
      files.scene[fmt::format("mask_visib/000000_{:06d}.png", k)] = png_of(visible);
      models[std::to_string(object)] = model_json(mesh);
      poses.push_back(pose_json(placed, camera, object));
      infos.push_back(info_json(whole, visible, depths));
    }
    files.scene["rgb/000000.png"] = png_of_rgb(image.shaded_rgb(), camera.width(), camera.height());
    files.scene["depth/000000.png"] = png_of(depth_image(depths, scale));
    files.scene[kSceneCamera] = text_of(camera_json(camera, scale));
    files.scene[kGroundTruth] = text_of({{"0", poses}});
    files.scene[kGroundTruthInfo] = text_of({{"0", infos}});
    files.scene[kModelsInfo] = text_of(models);
    return files;
  }

  Files summarize(const std::vector<SceneEntry>& entries, const std::string& output) const override {
    Json models = Json::object(), targets = Json::array();
    for (const SceneEntry& entry : entries) {
      const std::string folder = output + "/" + scene_path(entry) + "/";
      models.update(read_json(folder + kModelsInfo));
      const Json infos = read_json(folder + kGroundTruthInfo).at("0");
      for (int k = 0; k < entry.tubes; ++k)
        if (infos.at(static_cast<std::size_t>(k)).at("visib_fract").get<double>() >= kTargetVisibility)
          targets.push_back(
              {{"im_id", 0}, {"inst_count", 1}, {"obj_id", entry.first_object + k}, {"scene_id", entry.number}});
    }
    Files files = {{std::string("models/") + kModelsInfo, text_of(models)},
                   {"test_targets_bop19.json", text_of(targets)}};
    if (!entries.empty()) files["camera.json"] = text_of(sensor_json(output + "/" + scene_path(entries.front())));
    return files;
  }

 private:
  /// The camera of all scenes of a data set.
  static Json sensor_json(const std::string& scene) {
    const Json camera = read_json(scene + "/" + kSceneCamera).at("0");
    const Json& k = camera.at("cam_K");
    return {{"cx", k[2]},
            {"cy", k[5]},
            {"depth_scale", camera.at("depth_scale")},
            {"fx", k[0]},
            {"fy", k[4]},
            {"height", std::lround(2.0 * k[5].get<double>()) + 1},
            {"width", std::lround(2.0 * k[2].get<double>()) + 1}};
  }
};

}  // namespace

std::unique_ptr<ExportFormat> bop_format() { return std::make_unique<BopFormat>(); }

}  // namespace tubebin::exports
