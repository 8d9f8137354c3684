#include "tubebin/scan/scanner.hpp"

#include <algorithm>
#include <cmath>
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

namespace tubebin::scan {
namespace {

const cloud::Point kNoPoint = cloud::Point::Constant(std::numeric_limits<float>::quiet_NaN());

SeenBodies bodies_of(scene::ScanRegion region) {
  if (region == scene::ScanRegion::tubes) return SeenBodies::tubes;
  return region == scene::ScanRegion::full ? SeenBodies::all : SeenBodies::bin_and_tubes;
}

scene::PixelWindow whole_image(const scene::Camera& camera) { return {0, 0, camera.width(), camera.height()}; }

/// Fills the points and labels of the pixels from (column, row) on to the right: no number and 0 where a pixel has no
/// point.
using PointsOfRow =
    std::function<void(int column, int row, std::span<cloud::Point> points, std::span<cloud::Label> labels)>;

/// Of a row's pixels, packet by packet.
void find_exact_points(const RayCaster& caster, const scene::Camera& camera, const PacketBodies& bodies, int column,
                       int row, std::span<cloud::Point> points, std::span<cloud::Label> labels) {
  const Vec3 scanner_in_world = camera.world_from_scanner().translation();
  for (std::size_t begin = 0; begin < points.size(); begin += kLanes) {
    const std::size_t count = std::min<std::size_t>(kLanes, points.size() - begin);
    const int first_column = column + static_cast<int>(begin);
    RayPacket packet(camera, first_column, row, caster.depth_min());
    caster.find_first_hits(packet, static_cast<int>(count), bodies.at(first_column, row));
    packet.get_first_points(scanner_in_world, points.subspan(begin, count), labels.subspan(begin, count));
  }
}

/// False where not all of the pixels are in the window of `bin_alone`.
bool copy_points(const Scan& bin_alone, int column, int row, std::span<cloud::Point> points) {
  const scene::PixelWindow& window = bin_alone.window;
  const int x = column - window.x, y = row - window.y;
  if (x < 0 || y < 0 || x + std::ssize(points) > window.width || y >= window.height) return false;
  std::copy_n(bin_alone.cloud.points.begin() + std::ptrdiff_t{y} * window.width + x, points.size(), points.begin());
  return true;
}

PointsOfRow exact_points(const RayCaster& caster, const scene::Camera& camera, const PacketBodies& bodies,
                         const Scan& bin_alone) {
  return [&](int column, int row, std::span<cloud::Point> points, std::span<cloud::Label> labels) {
    for (std::size_t begin = 0, end = 0; begin < points.size(); begin = end) {
      const auto bodies_at = [&](std::size_t i) -> const BodiesInReach& {
        return bodies.at(column + static_cast<int>(i), row);
      };
      const BodiesInReach& here = bodies_at(begin);
      do end = std::min(end + kLanes, points.size());
      while (end < points.size() && bodies_at(end).boxes == here.boxes &&
             (bodies_at(end).solid_count == 0) == (here.solid_count == 0));
      const int first_column = column + static_cast<int>(begin);
      const std::span points_here = points.subspan(begin, end - begin);
      const std::span labels_here = labels.subspan(begin, end - begin);
      if (here.solid_count == 0 && (copy_points(bin_alone, first_column, row, points_here) ||
                                    caster.find_bin_points(camera, first_column, row, here.boxes, points_here)))
        std::ranges::fill(labels_here, 0);
      else find_exact_points(caster, camera, bodies, first_column, row, points_here, labels_here);
    }
  };
}

PointsOfRow measured_points(const Measurement& measurement, const Reconstruction& reconstruction) {
  return [&](int column, int row, std::span<cloud::Point> points, std::span<cloud::Label> labels) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const int at = column + static_cast<int>(i);
      const std::optional<Hit> hit = measurement.measure(at, row);
      points[i] = hit ? cloud::Point(reconstruction.point_in_world(at, row, hit->depth).cast<float>()) : kNoPoint;
      labels[i] = hit ? hit->label : 0;
    }
  };
}

/// What lies outside `seen` is empty; what lies within has yet to be set.
void resize(cloud::Cloud& cloud, const scene::PixelWindow& window, const scene::PixelWindow& seen) {
  const auto pixels = static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height);
  cloud.width = static_cast<std::uint32_t>(window.width);
  cloud.height = static_cast<std::uint32_t>(window.height);
  if (seen == window) cloud.points.resize(pixels);
  else cloud.points.assign(pixels, kNoPoint);
  cloud.colors.assign(pixels, cloud::kNullColor);
  cloud.labels.assign(pixels, 0);
}

/// Neighbours mostly have the same label.
template <typename VisitRun>
void for_each_run(std::span<const cloud::Label> labels, const VisitRun& visit) {
  for (std::size_t begin = 0, end = 0; begin < labels.size(); begin = end) {
    while (end < labels.size() && labels[end] == labels[begin]) ++end;
    visit(labels[begin], begin, end);
  }
}

void count_pixels(std::span<const cloud::Label> labels, std::vector<std::size_t>& tube_pixels) {
  for_each_run(labels, [&](cloud::Label label, std::size_t begin, std::size_t end) {
    if (label > 0) tube_pixels[label - 1] += end - begin;
  });
}

void color_pixels(std::span<const cloud::Point> points, std::span<const cloud::Label> labels,
                  std::span<const cloud::Color> colors, std::span<cloud::Color> pixels) {
  for_each_run(labels, [&](cloud::Label label, std::size_t begin, std::size_t end) {
    const cloud::Color color = colors[label];
    for (std::size_t i = begin; i < end; ++i) pixels[i] = std::isnan(points[i].x()) ? cloud::kNullColor : color;
  });
}

/// One point a pixel of `scan.window`; what lies outside `seen` shows nothing.
void scan_organized(const PointsOfRow& points_of_row, const scene::PixelWindow& seen,
                    const std::vector<cloud::Color>& colors, Scan& scan) {
  resize(scan.cloud, scan.window, seen);
  const auto width = static_cast<std::size_t>(seen.width);
  for (int row = seen.y; row < seen.y + seen.height; ++row) {
    const auto begin = static_cast<std::size_t>(row - scan.window.y) * scan.cloud.width +
                       static_cast<std::size_t>(seen.x - scan.window.x);
    const std::span<cloud::Point> points = std::span(scan.cloud.points).subspan(begin, width);
    const std::span<cloud::Label> labels = std::span(scan.cloud.labels).subspan(begin, width);
    points_of_row(seen.x, row, points, labels);
    count_pixels(labels, scan.tube_pixels);
    color_pixels(points, labels, colors, std::span(scan.cloud.colors).subspan(begin, width));
  }
}

void scan_tubes(const PointsOfRow& points_of_row, const std::vector<cloud::Color>& colors, Scan& scan) {
  std::vector<cloud::Point> points(static_cast<std::size_t>(scan.window.width));
  std::vector<cloud::Label> labels(points.size());
  for (int row = scan.window.y; row < scan.window.y + scan.window.height; ++row) {
    points_of_row(scan.window.x, row, points, labels);
    count_pixels(labels, scan.tube_pixels);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (labels[i] == 0) continue;
      scan.cloud.points.push_back(points[i]);
      scan.cloud.colors.push_back(colors[labels[i]]);
      scan.cloud.labels.push_back(labels[i]);
    }
  }
  scan.cloud.width = static_cast<std::uint32_t>(scan.cloud.size());
}

void scan_region(const PointsOfRow& points_of_row, const scene::PixelWindow& seen, scene::ScanRegion region,
                 Scan& scan) {
  const std::vector<cloud::Color> colors = cloud::label_colors(scan.tube_pixels.size());
  if (region == scene::ScanRegion::tubes) scan_tubes(points_of_row, colors, scan);
  else scan_organized(points_of_row, seen, colors, scan);
}

}  // namespace

Scan scan(const scene::Scene& scene, std::uint64_t seed, const Scan& bin_alone) {
  const scene::Scanner& scanner = scene.scanner;
  const scene::Camera camera(scanner);
  SceneSolids solids = scene_solids(scene);
  const scene::PixelWindow seen = view_window(solids, bodies_of(scanner.region), camera, scanner.range_min);
  const RayCaster caster(std::move(solids), scanner.range_min, scanner.range_max);

  Scan scan;
  scan.window = scanner.region == scene::ScanRegion::full ? whole_image(camera) : seen;
  scan.tube_pixels.assign(scene.tubes.size(), 0);
  scan.cloud.world_from_sensor = camera.world_from_scanner();
  if (scanner.effects.any()) {
    const Measurement measurement(scene, caster, camera, seen, seed);
    const Reconstruction reconstruction(scanner);
    scan_region(measured_points(measurement, reconstruction), seen, scanner.region, scan);
  } else {
    const PacketBodies bodies(caster.solids(), camera, seen, caster.depth_min());
    scan_region(exact_points(caster, camera, bodies, bin_alone), seen, scanner.region, scan);
  }
  return scan;
}

const char* embree_version() { return RTC_VERSION_STRING; }

}  // namespace tubebin::scan
