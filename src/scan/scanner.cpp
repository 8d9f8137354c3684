#include "tubebin/scan/scanner.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <span>

#include "scan/embree.hpp"
#include "scan/measurement.hpp"
#include "scan/ray_caster.hpp"
#include "scan/view_window.hpp"
#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin {
namespace {

PixelWindow whole_image(const Camera& camera) { return {0, 0, camera.width(), camera.height()}; }

/// A pixel's point in world and its label.
struct LabelledPoint {
  Point point;
  Label label = 0;
};
/// Fills points[i] for the pixel (column + i, row); nothing where the pixel has no point.
using PointsOfRow = std::function<void(int column, int row, std::span<std::optional<LabelledPoint>> points)>;

PointsOfRow exact_points(const RayCaster& caster, const Camera& camera) {
  return [&](int column, int row, std::span<std::optional<LabelledPoint>> points) {
    const Vec3 scanner_in_world = camera.world_from_scanner().translation();
    std::array<Vec3, kLanes> directions;
    std::array<Hit, kLanes> hits;
    for (std::size_t begin = 0; begin < points.size(); begin += kLanes) {
      const std::size_t count = std::min<std::size_t>(kLanes, points.size() - begin);
      for (std::size_t i = 0; i < count; ++i)
        directions[i] = camera.pixel_direction_in_world(column + static_cast<int>(begin + i), row);
      caster.first_hits({directions.data(), count}, hits);
      for (std::size_t i = 0; i < count; ++i) {
        points[begin + i].reset();
        if (hits[i].found())
          points[begin + i] = {(scanner_in_world + hits[i].depth * directions[i]).cast<float>(), hits[i].label};
      }
    }
  };
}

PointsOfRow measured_points(const Measurement& measurement, const Reconstruction& reconstruction) {
  return [&](int column, int row, std::span<std::optional<LabelledPoint>> points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const int at = column + static_cast<int>(i);
      const std::optional<Hit> hit = measurement.measure(at, row);
      points[i].reset();
      if (hit) points[i] = {reconstruction.point_in_world(at, row, hit->depth).cast<float>(), hit->label};
    }
  };
}

/// Calls on_point(column, row, labelled point) for every pixel of the window that has one, row by row.
template <typename OnPoint>
void for_each_point(const PointsOfRow& points_of_row, const PixelWindow& window, const OnPoint& on_point) {
  std::vector<std::optional<LabelledPoint>> points(static_cast<std::size_t>(window.width));
  for (int row = window.y; row < window.y + window.height; ++row) {
    points_of_row(window.x, row, points);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (points[i]) on_point(window.x + static_cast<int>(i), row, *points[i]);
  }
}

void resize_empty(Cloud& cloud, const PixelWindow& window) {
  const auto pixels = static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height);
  cloud.width = static_cast<std::uint32_t>(window.width);
  cloud.height = static_cast<std::uint32_t>(window.height);
  cloud.points.assign(pixels, Point::Constant(std::numeric_limits<float>::quiet_NaN()));
  cloud.colors.assign(pixels, kNullColor);
  cloud.labels.assign(pixels, 0);
}

/// One point a pixel of `scan.window`; what lies outside `seen` shows neither bin nor tubes.
void scan_organized(const PointsOfRow& points_of_row, const PixelWindow& seen, const std::vector<Color>& colors,
                    Scan& scan) {
  resize_empty(scan.cloud, scan.window);
  for_each_point(points_of_row, seen, [&](int column, int row, const LabelledPoint& seen_point) {
    const auto index = static_cast<std::size_t>(row - scan.window.y) * scan.cloud.width +
                       static_cast<std::size_t>(column - scan.window.x);
    const Label label = seen_point.label;
    scan.cloud.points[index] = seen_point.point;
    scan.cloud.colors[index] = colors[label];
    scan.cloud.labels[index] = label;
    if (label > 0) ++scan.tube_pixels[label - 1];
  });
}

void scan_tubes(const PointsOfRow& points_of_row, const std::vector<Color>& colors, Scan& scan) {
  for_each_point(points_of_row, scan.window, [&](int, int, const LabelledPoint& seen_point) {
    const Label label = seen_point.label;
    if (label == 0) return;
    scan.cloud.points.push_back(seen_point.point);
    scan.cloud.colors.push_back(colors[label]);
    scan.cloud.labels.push_back(label);
    ++scan.tube_pixels[label - 1];
  });
  scan.cloud.width = static_cast<std::uint32_t>(scan.cloud.size());
}

void scan_region(const PointsOfRow& points_of_row, const PixelWindow& seen, ScanRegion region, Scan& scan) {
  const std::vector<Color> colors = label_colors(scan.tube_pixels.size());
  if (region == ScanRegion::tubes) scan_tubes(points_of_row, colors, scan);
  else scan_organized(points_of_row, seen, colors, scan);
}

}  // namespace

Scan scan(const Scene& scene, std::uint64_t seed) {
  const Scanner& scanner = scene.scanner;
  const Camera camera(scanner);
  SceneSolids solids = scene_solids(scene);
  const bool tubes_alone = scanner.region == ScanRegion::tubes;
  const PixelWindow seen =
      view_window(solids, tubes_alone ? SeenBodies::tubes : SeenBodies::bin_and_tubes, camera, scanner.range_min);
  const RayCaster caster(std::move(solids), scanner.range_min, scanner.range_max);

  Scan scan;
  scan.window = scanner.region == ScanRegion::full ? whole_image(camera) : seen;
  scan.tube_pixels.assign(scene.tubes.size(), 0);
  scan.cloud.world_from_sensor = camera.world_from_scanner();
  if (scanner.effects.any()) {
    const Measurement measurement(scene, caster, camera, seen, seed);
    const Reconstruction reconstruction(scanner);
    scan_region(measured_points(measurement, reconstruction), seen, scanner.region, scan);
  } else {
    scan_region(exact_points(caster, camera), seen, scanner.region, scan);
  }
  return scan;
}

Scan scan_exactly(Scene scene) {
  scene.scanner.effects = {};
  return scan(scene);
}

const char* embree_version() { return RTC_VERSION_STRING; }

}  // namespace tubebin
