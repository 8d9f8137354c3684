#include "dataset/surface_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tubebin::dataset {
namespace {

/// Of a convex body from how far a point is beyond each of its bounds (negative: short of it).
template <typename Vector>
double distance_from_bounds(const Vector& beyond) {
  const double outside = beyond.cwiseMax(0.0).norm();
  return outside > 0.0 ? outside : std::abs(beyond.maxCoeff());
}

}  // namespace

BodySurface::BodySurface(const scene::PlacedTube& placed) {
  const double wall = placed.tube.wall_thickness;
  const auto bore_radius = [&](double radius) { return wall > 0.0 ? radius - wall : 0.0; };
  for (const tube::Cylinder& cylinder : placed.tube.cylinders) {
    const Vec3 a = placed.node_in_world(cylinder.node_a);
    const Vec3 b = placed.node_in_world(cylinder.node_b);
    const double radius = placed.tube.radius_of(cylinder);
    cylinders_.push_back({.center = (a + b) / 2.0,
                          .axis = (b - a).normalized(),
                          .half_length = (b - a).norm() / 2.0,
                          .radius = radius,
                          .bore_radius = bore_radius(radius)});
  }
  const std::vector<int> degrees = placed.tube.node_degrees();
  const std::vector<double> radii = placed.tube.node_radii();
  for (std::size_t node = 0; node < degrees.size(); ++node)
    if (degrees[node] != 1)
      spheres_.push_back({placed.node_in_world(static_cast<int>(node)), radii[node], bore_radius(radii[node])});
}

BodySurface::BodySurface(const scene::Scene& scene) {
  mesh_ = scene::TriangleTree(scene::mesh_triangles(scene.bin));
  for (const auto& parts : {scene::bin_parts(scene.bin), scene::surrounding_boxes(scene)})
    for (const scene::BinPart& part : parts) boxes_.push_back({part.box, part.world_from_part.inverse()});
  for (const scene::StandingCylinder& cylinder : scene::surrounding_cylinders(scene))
    cylinders_.push_back({.center = cylinder.position + cylinder.height / 2.0 * Vec3::UnitZ(),
                          .axis = Vec3::UnitZ(),
                          .half_length = cylinder.height / 2.0,
                          .radius = cylinder.radius});
}

double BodySurface::distance(const Vec3& point) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const CappedCylinder& cylinder : cylinders_) {
    const Vec3 from_center = point - cylinder.center;
    const double along = from_center.dot(cylinder.axis);
    const double radial = (from_center - along * cylinder.axis).norm();
    // A pipe's section is a rectangle from bore to outside; without a bore only its outer side counts.
    const double middle = cylinder.bore_radius > 0.0 ? (cylinder.radius + cylinder.bore_radius) / 2.0 : 0.0;
    nearest =
        std::min(nearest, distance_from_bounds(Eigen::Vector2d(std::abs(radial - middle) - (cylinder.radius - middle),
                                                               std::abs(along) - cylinder.half_length)));
  }
  for (const Sphere& sphere : spheres_) {
    const double from_center = (point - sphere.center).norm();
    nearest = std::min(nearest, std::abs(from_center - sphere.radius));
    if (sphere.bore_radius > 0.0) nearest = std::min(nearest, std::abs(from_center - sphere.bore_radius));
  }
  for (const auto& [box, box_from_world] : boxes_) {
    const Vec3 p = box_from_world * point;
    nearest = std::min(nearest, distance_from_bounds(Vec3((p - box.center()).cwiseAbs() - box.sizes() / 2.0)));
  }
  return std::min(nearest, mesh_.distance(point));
}

std::vector<BodySurface> surfaces_of(const scene::Scene& scene) {
  std::vector<BodySurface> surfaces = {BodySurface(scene)};
  for (const scene::PlacedTube& tube : scene.tubes) surfaces.emplace_back(tube);
  return surfaces;
}

}  // namespace tubebin::dataset
