#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/json_reader.hpp"
#include "core/png.hpp"
#include "export/formats.hpp"
#include "export/mask_encoder.hpp"
#include "export/symmetries.hpp"
#include "export/tube_mesh_file.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/scene/depth_image.hpp"

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
constexpr const char* kSensor = "camera.json";
/// The toolkit evaluates on meshes of a folder of their own.
constexpr const char* kModelFolders[] = {"models", "models_eval"};

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

Json camera_json(const SceneImage& image, double scale) {
  const Pose scanner_from_world = image.camera().world_from_scanner().inverse();
  return {{"0",
           {{"cam_K", rows_of(image.intrinsics())},
            {"cam_R_w2c", rows_of(scanner_from_world.linear())},
            {"cam_t_w2c", millimetres(scanner_from_world.translation())},
            {"depth_scale", scale}}}};
}

Json sensor_json(const SceneImage& image, double scale) {
  const Eigen::Matrix3d k = image.intrinsics();
  return {{"cx", k(0, 2)},         {"cy", k(1, 2)}, {"depth_scale", scale},
          {"fx", k(0, 0)},         {"fy", k(1, 1)}, {"height", image.height()},
          {"width", image.width()}};
}

Json pose_json(const scene::PlacedTube& placed, const scene::Camera& camera, int object) {
  const Pose scanner_from_tube = camera.world_from_scanner().inverse() * placed.world_from_tube;
  return {{"obj_id", object},
          {"cam_R_m2c", rows_of(scanner_from_tube.linear())},
          {"cam_t_m2c", millimetres(scanner_from_tube.translation())}};
}

Json info_json(const Mask& whole, const Mask& visible, const Raster<std::uint16_t>& depths) {
  const auto valid = std::ranges::count_if(whole.pixels, [&](std::uint32_t i) { return depths.values[i] > 0; });
  const std::size_t all = whole.pixels.size(), seen = visible.pixels.size();
  return {{"bbox_obj", box_json(box_of(whole))},
          {"bbox_visib", box_json(box_of(visible))},
          {"px_count_all", all},
          {"px_count_valid", valid},
          {"px_count_visib", seen},
          {"visib_fract", all > 0 ? static_cast<double>(seen) / static_cast<double>(all) : 0.0}};
}

/// Row by row, as BOP has it; millimetres.
Json motion_json(const Pose& motion) {
  Pose motion_mm = motion;
  motion_mm.translation() *= kMillimetres;
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) rows.push_back(motion_mm.matrix()(row, column));
  return rows;
}

Json model_json(const TubeMeshFile& mesh, const tube::Tube& tube) {
  const Vec3 low = mesh.bounds_mm.min(), size = mesh.bounds_mm.sizes();
  Json model = {{"diameter", mesh.diameter_mm}, {"min_x", low.x()},   {"min_y", low.y()},  {"min_z", low.z()},
                {"size_x", size.x()},           {"size_y", size.y()}, {"size_z", size.z()}};
  const Symmetries symmetries = find_symmetries(tube);
  for (const Symmetries::Axis& axis : symmetries.continuous)
    model["symmetries_continuous"].push_back(
        {{"axis", {axis.direction.x(), axis.direction.y(), axis.direction.z()}}, {"offset", millimetres(axis.origin)}});
  for (const Pose& motion : symmetries.discrete) model["symmetries_discrete"].push_back(motion_json(motion));
  if (!tube.kind.empty()) model["kind"] = tube.kind;
  return model;
}

/// An image's targets: how often each object of which enough is visible is there.
void add_targets(const SceneEntry& entry, const Json& infos, Json& targets) {
  std::map<int, int> instances;
  for (std::size_t k = 0; k < entry.tubes.size(); ++k)
    if (infos.at(k).at("visib_fract").get<double>() >= kTargetVisibility) ++instances[entry.tubes[k].object];
  for (const auto& [object, count] : instances)
    targets.push_back({{"im_id", 0}, {"inst_count", count}, {"obj_id", object}, {"scene_id", entry.number}});
}

class BopFormat : public ExportFormat {
 public:
  explicit BopFormat(ImageRegion region) : region_(region) {}

  std::string scene_path(const SceneEntry& entry) const override { return fmt::format("test/{:06d}", entry.number); }

  SceneFiles export_scene(const SceneToExport& scene) const override {
    const SceneImage image(scene, region_);
    const scene::Camera& camera = image.camera();
    const double scale = scene::DepthScale(scene.record.scene.scanner).mm_per_unit();
    const Raster<std::uint16_t> depths = image.depths();
    const auto views = scan::view_tubes_alone(scene.record.scene);
    const std::vector<Mask> visible = image.visible_masks();
    const MaskEncoder masks(image.width(), image.height());
    SceneFiles files;
    Json poses = Json::array(), infos = Json::array(), models = Json::object();
    for (std::size_t k = 0; k < views.size(); ++k) {
      const scene::PlacedTube& placed = scene.record.scene.tubes[k];
      const int object = scene.entry.tubes[k].object;
      const TubeMeshFile mesh = tube_mesh_file(placed.tube);
      const Mask whole = image.mask_of(views[k]);
      for (const char* folder : kModelFolders)
        files.beside[fmt::format("{}/obj_{:06d}.ply", folder, object)] = mesh.ply;
      files.scene[fmt::format("mask/000000_{:06d}.png", k)] = masks.png_of(whole);
      files.scene[fmt::format("mask_visib/000000_{:06d}.png", k)] = masks.png_of(visible[k]);
      models[std::to_string(object)] = model_json(mesh, placed.tube);
      poses.push_back(pose_json(placed, camera, object));
      infos.push_back(info_json(whole, visible[k], depths));
    }
    files.scene["rgb/000000.png"] = encode_rgb_png(image.shaded_rgb(), image.width(), image.height());
    files.scene["depth/000000.png"] = encode_grey_png(depths.values, depths.width, depths.height);
    files.scene[kSceneCamera] = text_of(camera_json(image, scale));
    files.scene[kSensor] = text_of(sensor_json(image, scale));
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
      add_targets(entry, read_json(folder + kGroundTruthInfo).at("0"), targets);
    }
    Files files = {{"test_targets_bop19.json", text_of(targets)}};
    for (const char* folder : kModelFolders) files[std::string(folder) + "/" + kModelsInfo] = text_of(models);
    if (!entries.empty()) files[kSensor] = read_file(output + "/" + scene_path(entries.front()) + "/" + kSensor);
    return files;
  }

 private:
  ImageRegion region_;
};

}  // namespace

std::unique_ptr<ExportFormat> bop_format(ImageRegion region) { return std::make_unique<BopFormat>(region); }

}  // namespace tubebin::exports
