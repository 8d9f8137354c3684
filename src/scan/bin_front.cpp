#include "scan/bin_front.hpp"

#include "scan/solid_outline.hpp"
#include "scan/view_window.hpp"

namespace tubebin::scan {

namespace {

scene::Box bounds_of(const SolidBox& box) {
  scene::Box bounds;
  for (const Vec3& corner : box.corners()) bounds.extend(corner);
  return bounds;
}

}  // namespace

BinFront::BinFront(const scene::Scene& scene, const scene::Camera& camera)
    : camera_(camera), depth_min_(scene.scanner.range_min - kDepthTolerance) {
  for (const SolidBox& box : scene_solids({scene.bin, scene.scanner, {}}).bin)
    boxes_.push_back({box, view_window({{}, {}, {box}}, SeenBodies::bin_and_tubes, camera, scene.scanner.range_min),
                      scan::nearest_depth(bounds_of(box), camera)});
}

double BinFront::first_before(double depth, int column, int row) {
  inside_.clear();
  for (const auto& [box, window, nearest] : boxes_) {
    if (nearest > depth || column < window.x || column >= window.x + window.width || row < window.y ||
        row >= window.y + window.height)
      continue;
    const Interval inside = box.intersect(camera_.pixel_direction_in_world(column, row));
    if (!inside.empty()) inside_.push_back(inside);
  }
  return inside_.empty() ? std::numeric_limits<double>::infinity() : first_boundary(inside_, depth_min_);
}

}  // namespace tubebin::scan
