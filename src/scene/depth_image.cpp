#include "tubebin/scene/depth_image.hpp"

#include <algorithm>
#include <cmath>

#include "core/png.hpp"

namespace tubebin::scene {
namespace {

constexpr double kMillimetres = 1000.0;
constexpr double kHighest = 65535.0;
constexpr const char* kDepthFile = "depth.png";
constexpr const char* kLabelsFile = "labels.png";

void require_organized(const cloud::Cloud& cloud, const SceneRecord& record) {
  const PixelWindow& window = record.window;
  if (cloud.width != static_cast<std::uint32_t>(window.width) ||
      cloud.height != static_cast<std::uint32_t>(window.height))
    throw_io_error(
        "{}: has no depth image: its cloud has {} x {} points, which are not the {} x {} pixels of a scanner",
        record.id, cloud.width, cloud.height, window.width, window.height);
  if (cloud.labels.size() != cloud.size()) throw_io_error("{}: the cloud has no labels", record.id);
}

}  // namespace

DepthScale::DepthScale(const Scanner& scanner) : scanner_from_world_(scanner.world_from_scanner().inverse()) {
  while (scanner.range_max * kMillimetres / mm_per_unit_ > kHighest) mm_per_unit_ *= 10.0;
}

std::uint16_t DepthScale::depth(const cloud::Point& p_in_world) const {
  const auto depth = static_cast<float>((scanner_from_world_ * p_in_world.cast<double>()).z());  // as exact as a cloud
  const double units = static_cast<double>(depth) * kMillimetres / mm_per_unit_;
  return static_cast<std::uint16_t>(std::lround(std::clamp(units, 0.0, kHighest)));
}

DepthImage depth_image(const cloud::Cloud& cloud, const SceneRecord& record) {
  require_organized(cloud, record);
  const DepthScale scale(record.scene.scanner);
  DepthImage image{record.window.width, record.window.height, scale.mm_per_unit(),
                   std::vector<std::uint16_t>(cloud.size(), 0), std::vector<std::uint16_t>(cloud.size(), 0)};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud::is_finite(cloud.points[i])) continue;
    image.depths[i] = scale.depth(cloud.points[i]);
    image.labels[i] = static_cast<std::uint16_t>(cloud.labels[i]);
  }
  return image;
}

std::map<std::string, std::string> format_depth_image(const DepthImage& image) {
  return {{kDepthFile, encode_grey_png(image.depths, image.width, image.height)},
          {kLabelsFile, encode_grey_png(image.labels, image.width, image.height)}};
}

DepthImage read_depth_image(const DatasetFiles& files, const ConfinedPath& scene, const SceneRecord& record) {
  if (!record.depth_mm_per_unit) {
    const std::string cloud = files.cloud_of(scene);
    return depth_image(parse_scene_cloud(files.read(scene, cloud), files.place(scene, cloud), record), record);
  }
  const PixelWindow& window = record.window;
  const auto read = [&](const char* file) {
    return decode_grey_png(files.read(scene, file), files.place(scene, file), window.width, window.height);
  };
  return {window.width, window.height, *record.depth_mm_per_unit, read(kDepthFile), read(kLabelsFile)};
}

}  // namespace tubebin::scene
