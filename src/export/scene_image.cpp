#include "export/scene_image.hpp"

#include <algorithm>
#include <cmath>

#include "export/surface_normal.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/scene/depth_image.hpp"

namespace tubebin::exports {
namespace {

struct Pixel {
  int column = 0;
  int row = 0;
};

Pixel pixel_of_organized(std::size_t index, const scene::PixelWindow& window) {
  const auto width = static_cast<std::size_t>(window.width);
  return {window.x + static_cast<int>(index % width), window.y + static_cast<int>(index / width)};
}

Pixel pixel_on_ray(const cloud::Point& point, const scene::Camera& camera) {
  const Eigen::Vector2d place = camera.project_from_world(point.cast<double>());
  return {static_cast<int>(std::floor(place.x())), static_cast<int>(std::floor(place.y()))};
}

/// The pixels that the bin's corners span; all where the scanner does not have the whole bin before it.
scene::PixelWindow bin_window(const scene::Scene& scene, const scene::Camera& camera) {
  const Pose scanner_from_world = camera.world_from_scanner().inverse();
  Eigen::AlignedBox2d bounds;
  std::vector<scene::BinPart> parts = scene::bin_parts(scene.bin);
  if (parts.empty()) parts.push_back({scene::bin_bounds(scene.bin)});
  for (const scene::BinPart& part : parts)
    for (const Vec3& corner : part.corners_in_world()) {
      const Vec3 p_in_scanner = scanner_from_world * corner;
      if (p_in_scanner.z() < scene.scanner.range_min) return {0, 0, camera.width(), camera.height()};
      bounds.extend(camera.project(p_in_scanner));
    }
  bounds = bounds.intersection(
      Eigen::AlignedBox2d(Eigen::Vector2d::Zero(), Eigen::Vector2d(camera.width(), camera.height())));
  if (bounds.isEmpty()) return {0, 0, camera.width(), camera.height()};
  const Eigen::Vector2i low = bounds.min().array().floor().cast<int>(), high = bounds.max().array().ceil().cast<int>();
  return {low.x(), low.y(), high.x() - low.x(), high.y() - low.y()};
}

void check_consistent(const SceneToExport& scene) {
  const cloud::Cloud& cloud = scene.cloud;
  const scene::PixelWindow& window = scene.record.window;
  if (cloud.labels.size() != cloud.size()) throw_io_error("{}: the cloud has no labels", scene.entry.name);
  if (cloud.organized() && (cloud.width != static_cast<std::uint32_t>(window.width) ||
                            cloud.height != static_cast<std::uint32_t>(window.height)))
    throw_io_error("{}: the cloud has {} x {} points, the window of scene.json {} x {}", scene.entry.name, cloud.width,
                   cloud.height, window.width, window.height);
  const auto highest = std::ranges::max_element(cloud.labels);
  if (highest != cloud.labels.end() && *highest > scene.record.scene.tubes.size())
    throw_io_error("{}: the cloud has label {}, scene.json {} tubes", scene.entry.name, *highest,
                   scene.record.scene.tubes.size());
}

}  // namespace

SceneImage::SceneImage(const SceneToExport& scene, ImageRegion region)
    : scene_(scene),
      camera_(scene.record.scene.scanner),
      region_(region == ImageRegion::bin ? bin_window(scene.record.scene, camera_)
                                         : scene::PixelWindow{0, 0, camera_.width(), camera_.height()}),
      points_(region_.width, region_.height, -1) {
  check_consistent(scene);
  const cloud::Cloud& cloud = scene.cloud;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud::is_finite(cloud.points[i]) || (!cloud.sources.empty() && cloud.sources[i] != 0)) continue;
    const Pixel pixel =
        cloud.organized() ? pixel_of_organized(i, scene.record.window) : pixel_on_ray(cloud.points[i], camera_);
    if (has(pixel.column, pixel.row)) points_.at(pixel.column - region_.x, pixel.row - region_.y) = static_cast<int>(i);
  }
}

bool SceneImage::has(int column, int row) const {
  return column >= region_.x && column < region_.x + region_.width && row >= region_.y &&
         row < region_.y + region_.height;
}

Raster<std::uint16_t> SceneImage::depths() const {
  Raster<std::uint16_t> depths(points_.width, points_.height, 0);
  const scene::DepthScale scale(scene_.record.scene.scanner);
  for (std::size_t i = 0; i < points_.values.size(); ++i)
    if (const int point = points_.values[i]; point >= 0)
      depths.values[i] = scale.depth(scene_.cloud.points[static_cast<std::size_t>(point)]);
  return depths;
}

std::vector<Mask> SceneImage::visible_masks() const {
  std::vector<Mask> masks(scene_.record.scene.tubes.size(), {points_.width, points_.height, {}});
  for (std::size_t i = 0; i < points_.values.size(); ++i) {
    if (points_.values[i] < 0) continue;
    const cloud::Label label = scene_.cloud.labels[static_cast<std::size_t>(points_.values[i])];
    if (label > 0) masks[label - 1].pixels.push_back(static_cast<std::uint32_t>(i));
  }
  return masks;
}

// Lambert's cosine with some ambient light; the lamp is at the scanner, so nothing that it sees is in shadow.
std::vector<std::uint8_t> SceneImage::shaded_rgb() const {
  constexpr double kAmbient = 0.25;
  const Vec3 tube_color(225, 222, 215), bin_color(95, 104, 118);
  const SurfaceNormals normals(scene_.record.scene);
  const Vec3 lamp = camera_.world_from_scanner().translation();
  std::vector<std::uint8_t> rgb(3 * points_.values.size(), 0);
  for (std::size_t i = 0; i < points_.values.size(); ++i) {
    if (points_.values[i] < 0) continue;
    const auto point = static_cast<std::size_t>(points_.values[i]);
    const Vec3 place = scene_.cloud.points[point].cast<double>();
    const cloud::Label label = scene_.cloud.labels[point];
    const double cosine = std::max(0.0, normals.at(label, place).dot((lamp - place).normalized()));
    const Vec3 color = (kAmbient + (1.0 - kAmbient) * cosine) * (label > 0 ? tube_color : bin_color);
    for (int c = 0; c < 3; ++c)
      rgb[3 * i + static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(std::lround(color[c]));
  }
  return rgb;
}

Mask SceneImage::mask_of(const std::vector<scan::SeenPixel>& pixels) const {
  Mask mask{region_.width, region_.height, {}};
  for (const scan::SeenPixel& pixel : pixels)
    if (has(pixel.column, pixel.row))
      mask.pixels.push_back(
          static_cast<std::uint32_t>((pixel.row - region_.y) * region_.width + pixel.column - region_.x));
  return mask;
}

PixelBox box_of(const Mask& mask) {
  Eigen::AlignedBox2i bounds;
  for (const std::uint32_t pixel : mask.pixels)
    bounds.extend(Eigen::Vector2i(static_cast<int>(pixel) % mask.width, static_cast<int>(pixel) / mask.width));
  if (bounds.isEmpty()) return {};
  return {bounds.min().x(), bounds.min().y(), bounds.sizes().x() + 1, bounds.sizes().y() + 1};
}

}  // namespace tubebin::exports
