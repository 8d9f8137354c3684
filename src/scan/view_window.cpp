#include "scan/view_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tubebin::scan {
namespace {

/// A plane at depth zero can't be projected; nothing is nearer than this (metres).
constexpr double kNearestDepth = 1e-6;

using Corners = std::array<Vec3, 8>;

/// Grows over what is projected into the image.
class ViewBounds {
 public:
  ViewBounds(const scene::Camera& camera, double depth_min)
      : camera_(camera),
        scanner_from_seen_(camera.world_from_scanner().linear().transpose()),
        depth_min_(std::max(depth_min, kNearestDepth)) {}

  void add_box(const SolidBox& box) { add_hexahedron(box.corners()); }

  void add_triangle(const scene::Triangle& triangle) {
    const auto& [a, b, c] = triangle.corners;
    add_hexahedron({a, b, c, c, a, b, c, c});
  }

  void add_cylinder(const SolidCylinder& cylinder) {
    if (!add_disc(cylinder.base(), cylinder.axis(), cylinder.radius()) ||
        !add_disc(cylinder.top(), cylinder.axis(), cylinder.radius()))
      add_hull_box(cylinder);
  }

  void add_sphere(const SolidSphere& sphere) {
    if (!add_disc(sphere.center(), Vec3::Zero(), sphere.radius())) add_box(SolidBox(sphere.bounds()));
  }

  scene::PixelWindow window() const {
    // Pixel c is in where its centre c + 0.5 is.
    const auto first = [](double low) { return static_cast<int>(std::ceil(low - 0.5 - kRoundingPixels)); };
    const auto last = [](double high) { return static_cast<int>(std::floor(high - 0.5 + kRoundingPixels)); };
    if (bounds_.isEmpty()) return {};
    const Eigen::Vector2d low = bounds_.min().cwiseMax(Eigen::Vector2d::Zero());
    const Eigen::Vector2d high = bounds_.max().cwiseMin(Eigen::Vector2d(camera_.width(), camera_.height()));
    scene::PixelWindow window;
    window.x = std::max(first(low.x()), 0);
    window.y = std::max(first(low.y()), 0);
    window.width = std::min(last(high.x()), camera_.width() - 1) - window.x + 1;
    window.height = std::min(last(high.y()), camera_.height() - 1) - window.y + 1;
    return window.width > 0 && window.height > 0 ? window : scene::PixelWindow{};
  }

 private:
  static constexpr double kRoundingPixels = 1e-6;

  void add_point(const Vec3& p_in_scanner) { bounds_.extend(camera_.project(p_in_scanner)); }

  /// The part of a convex body with quadrilateral faces that is deep enough. Corners are numbered as a box's:
  /// bit k of the index says on which side along axis k.
  void add_hexahedron(const Corners& corners_seen) {
    Corners corners;
    std::ranges::transform(corners_seen, corners.begin(),
                           [&](const Vec3& corner) -> Vec3 { return scanner_from_seen_ * corner; });
    for (std::size_t i = 0; i < 8; ++i) {
      if (corners[i].z() >= depth_min_) add_point(corners[i]);
      for (std::size_t bit = 1; bit < 8; bit <<= 1)
        if ((i & bit) == 0) add_crossing(corners[i], corners[i | bit]);
    }
  }

  /// Where an edge passes through the nearest depth.
  void add_crossing(const Vec3& a, const Vec3& b) {
    if ((a.z() < depth_min_) == (b.z() < depth_min_)) return;
    Vec3 crossing = a + (b - a) * ((depth_min_ - a.z()) / (b.z() - a.z()));
    crossing.z() = depth_min_;
    add_point(crossing);
  }

  /// The box around a cylinder, along its axis.
  void add_hull_box(const SolidCylinder& cylinder) {
    const Vec3 u = cylinder.axis().unitOrthogonal() * cylinder.radius();
    const Vec3 v = cylinder.axis().cross(u);
    Corners corners;
    for (std::size_t i = 0; i < 8; ++i)
      corners[i] = ((i & 4) ? cylinder.top() : cylinder.base()) + ((i & 1) ? u : -u) + ((i & 2) ? v : -v);
    add_hexahedron(corners);
  }

  /// A disc, or a sphere where `normal_seen` is zero, if all of it is deep enough; else returns false.
  bool add_disc(const Vec3& center_seen, const Vec3& normal_seen, double radius) {
    const Vec3 center = scanner_from_seen_ * center_seen;
    const Vec3 normal = scanner_from_seen_ * normal_seen;
    if (center.z() - radius * std::sqrt(std::max(0.0, 1.0 - normal.z() * normal.z())) < depth_min_) return false;
    const auto [left, right] = slopes(center, normal, radius, 0);
    const auto [above, below] = slopes(center, normal, radius, 1);
    add_point({left, above, 1.0});
    add_point({right, below, 1.0});
    return true;
  }

  /// The extreme values s of p[k] / p.z over the disc: the planes p[k] = s p.z touch it, so with w = e_k - s
  /// e_z, (w . center)^2 = radius^2 (|w|^2 - (w . normal)^2), a quadratic in s.
  static std::pair<double, double> slopes(const Vec3& center, const Vec3& normal, double radius, int k) {
    const double r2 = radius * radius;
    const double a = center.z() * center.z() - r2 * (1.0 - normal.z() * normal.z());
    const double half_b = center[k] * center.z() + r2 * normal[k] * normal.z();
    const double c = center[k] * center[k] - r2 * (1.0 - normal[k] * normal[k]);
    const double root = std::sqrt(std::max(0.0, half_b * half_b - a * c));
    return {(half_b - root) / a, (half_b + root) / a};
  }

  const scene::Camera& camera_;
  Eigen::Matrix3d scanner_from_seen_;
  double depth_min_;
  Eigen::AlignedBox2d bounds_;
};

}  // namespace

scene::PixelWindow view_window(const SceneSolids& solids, SeenBodies bodies, const scene::Camera& camera,
                               double depth_min) {
  ViewBounds bounds(camera, depth_min);
  for (const auto& cylinder : solids.cylinders) bounds.add_cylinder(cylinder.solid);
  for (const auto& sphere : solids.spheres) bounds.add_sphere(sphere.solid);
  if (bodies != SeenBodies::tubes) {
    for (const SolidBox& box : solids.bin) bounds.add_box(box);
    for (const scene::Triangle& triangle : solids.bin_mesh) bounds.add_triangle(triangle);
  }
  if (bodies == SeenBodies::all) {
    for (const auto& box : solids.boxes_around) bounds.add_box(box.solid);
    for (const auto& cylinder : solids.cylinders_around) bounds.add_cylinder(cylinder.solid);
  }
  return bounds.window();
}

}  // namespace tubebin::scan
