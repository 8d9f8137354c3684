#include "tubebin/scan/scanner.hpp"

#include <limits>

#include "scan/embree.hpp"
#include "scan/ray_caster.hpp"
#include "scan/view_window.hpp"
#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin {
namespace {

PixelWindow whole_image(const Camera& camera) { return {0, 0, camera.width(), camera.height()}; }

/// Calls on_hit(column, row, point in world, label) for every pixel of the window that sees a surface, row by
/// row.
template <typename OnHit>
void cast_rays(const RayCaster& caster, const Camera& camera, const PixelWindow& window, const OnHit& on_hit) {
  const Vec3 scanner_in_world = camera.world_from_scanner().translation();
  for (int row = window.y; row < window.y + window.height; ++row) {
    for (int column = window.x; column < window.x + window.width; ++column) {
      const Vec3 direction = camera.pixel_direction_in_world(column, row);
      const Hit hit = caster.first_hit(direction);
      if (!hit.found()) continue;
      const Point point = (scanner_in_world + hit.depth * direction).cast<float>();
      on_hit(column, row, point, hit.label);
    }
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
void scan_organized(const RayCaster& caster, const Camera& camera, const PixelWindow& seen,
                    const std::vector<Color>& colors, Scan& scan) {
  resize_empty(scan.cloud, scan.window);
  cast_rays(caster, camera, seen, [&](int column, int row, const Point& point, Label label) {
    const auto index = static_cast<std::size_t>(row - scan.window.y) * scan.cloud.width +
                       static_cast<std::size_t>(column - scan.window.x);
    scan.cloud.points[index] = point;
    scan.cloud.colors[index] = colors[label];
    scan.cloud.labels[index] = label;
    if (label > 0) ++scan.tube_pixels[label - 1];
  });
}

void scan_tubes(const RayCaster& caster, const Camera& camera, const std::vector<Color>& colors, Scan& scan) {
  cast_rays(caster, camera, scan.window, [&](int, int, const Point& point, Label label) {
    if (label == 0) return;
    scan.cloud.points.push_back(point);
    scan.cloud.colors.push_back(colors[label]);
    scan.cloud.labels.push_back(label);
    ++scan.tube_pixels[label - 1];
  });
  scan.cloud.width = static_cast<std::uint32_t>(scan.cloud.size());
}

}  // namespace

Scan scan(const Scene& scene) {
  const Scanner& scanner = scene.scanner;
  const Camera camera(scanner);
  SceneSolids solids = scene_solids(scene);
  const bool tubes_alone = scanner.region == ScanRegion::tubes;
  const PixelWindow seen =
      view_window(solids, tubes_alone ? SeenBodies::tubes : SeenBodies::bin_and_tubes, camera, scanner.range_min);
  const RayCaster caster(std::move(solids), scanner.range_min, scanner.range_max);
  const std::vector<Color> colors = label_colors(scene.tubes.size());

  Scan scan;
  scan.window = scanner.region == ScanRegion::full ? whole_image(camera) : seen;
  scan.tube_pixels.assign(scene.tubes.size(), 0);
  scan.cloud.world_from_sensor = camera.world_from_scanner();
  if (tubes_alone) scan_tubes(caster, camera, colors, scan);
  else scan_organized(caster, camera, seen, colors, scan);
  return scan;
}

const char* embree_version() { return RTC_VERSION_STRING; }

}  // namespace tubebin
