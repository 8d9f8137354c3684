#include "tubebin/results/model_cloud.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <new>
#include <numbers>

#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/file_record.hpp"
#include "tubebin/core/path_status.hpp"

namespace tubebin::results {
namespace {

namespace fs = std::filesystem;

std::optional<scene::Bin> choose_bin(const CloudToModel& input, const ModelConfig& config) {
  if (config.bin_source == BinSource::config) return config.bin;
  if (config.bin_source == BinSource::automatic && input.scene && !input.scene->scene.bin.has_mesh())
    return input.scene->scene.bin;  // one of another form is found in the cloud
  return std::nullopt;
}

/// The origin of the cloud's frame, where scene.json says of a bin's size alone.
Pose choose_bin_pose(const ModelConfig& config) {
  Pose pose = Pose::Identity();
  if (config.bin_source != BinSource::config) return pose;
  const Vec3 angles = config.bin_rotation_deg * (std::numbers::pi / 180.0);
  pose.linear() = (Eigen::AngleAxisd(angles.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angles.y(), Vec3::UnitY()) *
                   Eigen::AngleAxisd(angles.x(), Vec3::UnitX()))
                      .toRotationMatrix();
  pose.translation() = config.bin_position;
  return pose;
}

Pose choose_sensor(const CloudToModel& input, const ModelConfig& config) {
  Pose pose = input.cloud.world_from_sensor;
  if (!config.viewpoint.isZero()) pose.translation() = config.viewpoint;
  return pose;
}

/// Of sources 1, 2, ...
std::vector<Pose> choose_further_sensors(const CloudToModel& input, const ModelConfig& config) {
  std::vector<Pose> poses = input.world_from_further_sensors;
  if (poses.empty() && config.viewpoint.isZero() && input.scene && !input.cloud.sources.empty())
    for (const scene::Scanner& scanner : input.scene->scene.further_scanners)
      poses.push_back(scanner.world_from_scanner());
  return poses;
}

std::size_t count_sources(const cloud::Cloud& cloud) {
  return cloud.sources.empty() ? 1 : std::size_t{*std::ranges::max_element(cloud.sources)} + 1;
}

/// One alone that is not told, the file's, does for any cloud.
void require_viewpoint_per_source(const CloudToModel& input, const ModelConfig& config, std::size_t viewpoints) {
  if (viewpoints == 1 && config.viewpoint.isZero()) return;
  if (viewpoints > 1 && input.cloud.sources.empty())
    throw_config_error(
        "{}: has no field source, and {} viewpoints are told; valid: one, or a cloud whose points say which scanner "
        "saw them",
        input.path, viewpoints);
  if (const std::size_t sources = count_sources(input.cloud); sources > viewpoints)
    throw_config_error("{}: has {} sources, and the viewpoints of {} are told; valid: one for each source, from 0",
                       input.path, sources, viewpoints);
}

/// Beyond it, neighbours of a float differ by more than a tube's wall, and squares and grids overflow.
constexpr float kFarthest = 1e5F;  // metres

void require_near(const CloudToModel& input) {
  const auto is_far = [](const cloud::Point& p) { return cloud::is_finite(p) && p.cwiseAbs().maxCoeff() > kFarthest; };
  const auto far = std::find_if(input.cloud.points.begin(), input.cloud.points.end(), is_far);
  if (far == input.cloud.points.end()) return;
  throw_io_error(
      "{}: point {} is at {} {} {} m; valid: up to {} m from the origin. Is the unit right (--scale)? A point that "
      "was not measured is NaN",
      input.path, far - input.cloud.points.begin(), far->x(), far->y(), far->z(), kFarthest);
}

/// `work` on the cloud's positions, its viewpoint and the bin; its errors name the file.
template <typename Work>
modeling::ModelingResult on_positions(const CloudToModel& input, const ModelConfig& config, const Work& work) {
  if (std::none_of(input.cloud.points.begin(), input.cloud.points.end(), cloud::is_finite))
    throw_io_error("{}: has no finite point", input.path);
  require_near(input);
  modeling::ModelingInput positions{.points = input.cloud.points,
                                    .world_from_sensor = choose_sensor(input, config),
                                    .world_from_further_sensors = choose_further_sensors(input, config),
                                    .bin = choose_bin(input, config),
                                    .world_from_bin = choose_bin_pose(config),
                                    .width = input.cloud.height > 1 ? input.cloud.width : 0};
  const std::size_t viewpoints = 1 + positions.world_from_further_sensors.size(), sources = count_sources(input.cloud);
  require_viewpoint_per_source(input, config, viewpoints);
  if (viewpoints > 1) positions.sources = input.cloud.sources;
  try {
    modeling::ModelingResult result = work(positions);
    if (sources > viewpoints)
      result.found.doubts.push_back(fmt::format(
          "the cloud has {} sources and the viewpoint of one: where did the others stand (--viewpoint)?", sources));
    return result;
  } catch (const IoError& error) {
    throw IoError(input.path + ": " + error.what());
  } catch (const std::bad_alloc&) {
    throw_io_error("{}: modelling its {} points takes more memory than there is", input.path, input.cloud.size());
  }
}

cloud::Cloud unorganized(const cloud::Cloud& input, std::size_t size) {
  cloud::Cloud cloud;
  cloud.width = static_cast<std::uint32_t>(size);
  cloud.world_from_sensor = input.world_from_sensor;
  cloud.points.reserve(size);
  return cloud;
}

}  // namespace

void describe(Fields& fields, ModelConfig& config) {
  describe(fields, config.modeling);
  fields.choice("bin_source", config.bin_source, {"automatic", "config", "cloud"},
                "which bin is cropped: scene.json's beside the cloud (else floor and walls are found), the one below, "
                "or floor and walls found in the cloud");
  fields.group("bin", "used with bin_source: config", [&](Fields& inner) { describe(inner, config.bin); });
  fields.vector("bin_position", config.bin_position, {-1000.0, 1000.0}, "m",
                "the middle of that bin's inner floor, in the cloud's frame; the cloud refines it");
  fields.vector("bin_rotation_deg", config.bin_rotation_deg, {-360.0, 360.0}, "degrees",
                "roll, pitch, yaw of that bin: about x, then y, then z of the cloud's frame");
  fields.vector("viewpoint", config.viewpoint, {-1000.0, 1000.0}, "m",
                "where the scanner stood; zeros: as the cloud's file says");
}

ModelConfig load_model_config(const std::string& path) {
  ModelConfig config;
  const KeyPlaces places = read_yaml_file(path, [&](Fields& fields) { describe(fields, config); });
  scene::check(config.bin, places, "bin");
  modeling::check(config.modeling, places);
  return config;
}

CloudToModel read_cloud_to_model(const std::string& path, double scale) {
  const auto start = std::chrono::steady_clock::now();
  CloudToModel input{.path = path, .cloud = {}, .scene = std::nullopt, .hashes = {}};
  if (const std::string scene = (fs::path(path).parent_path() / "scene.json").string(); path_exists(scene))
    input.scene = scene::read_scene_json(scene);
  // scene.json knows the unit: whoever tells it, too, tells the same.
  if (input.scene && (scale == 1.0 || scale == input.scene->space.metres_per_unit()))
    input.cloud = scene::parse_scene_cloud(read_file(path), path, *input.scene);
  else input.cloud = cloud::read_cloud(path, scale);
  input.read_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return input;
}

CloudToModel read_cloud_to_model(const scene::DatasetFiles& files, const CloudFile& cloud) {
  const auto start = std::chrono::steady_clock::now();
  const std::string path = files.place(cloud.scene, cloud.file);
  const std::string bytes = files.read(cloud.scene, cloud.file);
  CloudToModel input{.path = path,
                     .cloud = {},
                     .scene = {},
                     .hashes = {.cloud_xxh128 = record_bytes(bytes).xxh128, .scene_json_xxh128 = ""}};
  if (files.has(cloud.scene, "scene.json")) {
    const std::string text = files.read(cloud.scene, "scene.json");
    input.hashes.scene_json_xxh128 = record_bytes(text).xxh128;
    input.scene = scene::parse_scene_json(text, files.place(cloud.scene, "scene.json"));
  }
  input.cloud = scene::parse_scene_cloud(bytes, path, input.scene.value_or(scene::SceneRecord{}));
  if (input.scene) {
    scene::require_same_scene(*input.scene, input.cloud, cloud.scene, files.place(cloud.scene, "scene.json"));
  }
  input.read_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return input;
}

modeling::ModelingResult model_cloud(const CloudToModel& input, const ModelConfig& config) {
  return on_positions(input, config, [&](const modeling::ModelingInput& positions) {
    return modeling::model_tubes(positions, config.modeling);
  });
}

modeling::ModelingResult label_cloud(const CloudToModel& input, const ModelConfig& config,
                                     std::vector<modeling::TubeModel> tubes) {
  return on_positions(input, config, [&](const modeling::ModelingInput& positions) {
    return modeling::label_tubes(positions, std::move(tubes), config.modeling);
  });
}

cloud::Cloud filtered_cloud(const cloud::Cloud& input, const modeling::ModelingResult& result) {
  cloud::Cloud cloud = unorganized(input, result.source.size());
  for (const std::uint32_t i : result.source) {
    cloud.points.push_back(input.points[i]);
    if (!input.colors.empty()) cloud.colors.push_back(input.colors[i]);
    if (!input.labels.empty()) cloud.labels.push_back(input.labels[i]);
    if (!input.sources.empty()) cloud.sources.push_back(input.sources[i]);
  }
  return cloud;
}

cloud::Cloud fully_labeled_cloud(const cloud::Cloud& input, const modeling::ModelingResult& result) {
  cloud::Cloud cloud = input;
  const std::vector<cloud::Color> colors = model_colors(result);
  cloud.labels = result.all_labels;
  cloud.colors.clear();
  for (const cloud::Label label : cloud.labels) cloud.colors.push_back(colors[label]);
  return cloud;
}

std::vector<cloud::Color> model_colors(const modeling::ModelingResult& result) {
  std::vector<cloud::Color> colors = cloud::label_colors(result.tubes.size());
  colors[0] = cloud::kNullColor;
  return colors;
}

cloud::Cloud labeled_cloud(const cloud::Cloud& input, const modeling::ModelingResult& result) {
  cloud::Cloud cloud = unorganized(input, result.source.size());
  const std::vector<cloud::Color> colors = model_colors(result);
  for (std::size_t k = 0; k < result.source.size(); ++k) {
    cloud.points.push_back(input.points[result.source[k]]);
    cloud.colors.push_back(colors[result.labels[k]]);
    cloud.labels.push_back(result.labels[k]);
  }
  return cloud;
}

}  // namespace tubebin::results
