#include "scan/bin_front.hpp"

#include "scan/solid_outline.hpp"

namespace tubebin::scan {

BinFront::BinFront(const scene::Scene& scene, const scene::Camera& camera)
    : camera_(camera), depth_min_(scene.scanner.range_min - kDepthTolerance) {
  SceneSolids solids = scene_solids({.bin = scene.bin,
                                     .scanner = scene.scanner,
                                     .tubes = {},
                                     .further_scanners = {},
                                     .surroundings = scene.surroundings});
  const auto add = [&](const auto& solid, const auto& outline) {
    parts_.push_back({solid, outline.window(), scan::nearest_depth(solid.bounds(), camera)});
  };
  const double depth_min = scene.scanner.range_min;
  for (const SolidBox& box : solids.bin) add(box, BoxOutline(box, camera, depth_min));
  if (!solids.bin_mesh.empty()) {
    mesh_ = std::make_unique<MeshCaster>(std::move(solids.bin_mesh));
    Eigen::AlignedBox3d bounds = scene::bin_bounds(scene.bin);
    bounds.translate(-scene.scanner.position);
    parts_.push_back(
        {mesh_.get(), BoxOutline(SolidBox(bounds), camera, depth_min).window(), scan::nearest_depth(bounds, camera)});
  }
  for (const auto& box : solids.boxes_around) add(box.solid, BoxOutline(box.solid, camera, depth_min));
  for (const auto& cylinder : solids.cylinders_around)
    add(cylinder.solid, CylinderOutline(cylinder.solid, camera, depth_min));
}

double BinFront::first_before(double depth, int column, int row) {
  inside_.clear();
  double first = std::numeric_limits<double>::infinity();
  for (const auto& [solid, window, nearest] : parts_) {
    if (nearest > depth || column < window.x || column >= window.x + window.width || row < window.y ||
        row >= window.y + window.height)
      continue;
    const Vec3 direction = camera_.pixel_direction_in_world(column, row);
    const auto meet = [&](const auto& shape) {
      const Interval inside = shape.intersect(direction);
      if (!inside.empty()) inside_.push_back(inside);
    };
    if (const auto* box = std::get_if<SolidBox>(&solid)) meet(*box);
    else if (const auto* cylinder = std::get_if<SolidCylinder>(&solid)) meet(*cylinder);
    else first = mesh_->first_depth(direction, depth_min_, depth);
  }
  return inside_.empty() ? first : std::min(first, first_boundary(inside_, depth_min_));
}

}  // namespace tubebin::scan
