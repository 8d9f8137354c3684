#include "scan/solid_outline.hpp"

#include <algorithm>
#include <cmath>

#include "scan/view_window.hpp"

namespace tubebin::scan {
namespace {

/// Keeps the t of [from, to] with value + t * slope <= 0.
void limit(double value, double slope, double& from, double& to) {
  if (slope > 0.0) to = std::min(to, -value / slope);
  else if (slope < 0.0) from = std::max(from, -value / slope);
  else if (value > 0.0) to = -1.0;
}

scene::PixelWindow window_of(const SolidSphere& sphere, const scene::Camera& camera, double depth_min) {
  return view_window({{}, {{sphere, 0}}, {}}, SeenBodies::tubes, camera, depth_min);
}

}  // namespace

double nearest_depth(const scene::Box& box, const scene::Camera& camera) {
  const Vec3 axis = camera.world_from_scanner().linear().col(2);
  return axis.cwiseProduct(box.min()).cwiseMin(axis.cwiseProduct(box.max())).sum();
}

bool begins_before(const SceneSolids& solids, const scene::Camera& camera, double depth) {
  const auto is_nearer = [&](const auto& labelled) { return nearest_depth(labelled.solid.bounds(), camera) < depth; };
  return std::ranges::any_of(solids.cylinders, is_nearer) || std::ranges::any_of(solids.spheres, is_nearer);
}

bool ends_beyond(const SceneSolids& solids, const scene::Camera& camera, double depth) {
  const Vec3 axis = camera.world_from_scanner().linear().col(2);
  const auto is_farther = [&](const auto& labelled) {
    const scene::Box box = labelled.solid.bounds();
    return axis.cwiseProduct(box.min()).cwiseMax(axis.cwiseProduct(box.max())).sum() > depth;
  };
  return std::ranges::any_of(solids.cylinders, is_farther) || std::ranges::any_of(solids.spheres, is_farther);
}

bool is_hollow(const SceneSolids& tube) {
  return std::ranges::any_of(tube.cylinders, [](const auto& cylinder) { return cylinder.bore_radius > 0.0; });
}

std::vector<SceneSolids> solids_by_tube(const scene::Scene& scene, const SceneSolids& all) {
  std::vector<SceneSolids> by_tube(scene.tubes.size());
  for (const auto& cylinder : all.cylinders) by_tube[cylinder.label - 1].cylinders.push_back(cylinder);
  for (const auto& sphere : all.spheres) by_tube[sphere.label - 1].spheres.push_back(sphere);
  return by_tube;
}

CylinderOutline::CylinderOutline(const SolidCylinder& cylinder, const scene::Camera& camera, double depth_min)
    : whole_(view_window({{{cylinder, 0}}, {}, {}}, SeenBodies::tubes, camera, depth_min)) {
  const auto window_of_ball = [&](const Vec3& center) {
    return window_of(SolidSphere(center, cylinder.radius()), camera, depth_min);
  };
  const auto is_whole = [&](const scene::PixelWindow& w) {
    return w.x > 0 && w.y > 0 && w.x + w.width < camera.width() && w.y + w.height < camera.height() && w.width > 0;
  };
  base_ = window_of_ball(cylinder.base());
  top_ = window_of_ball(cylinder.top());
  is_hull_ = is_whole(base_) && is_whole(top_);
}

/// The hull is all rectangles between base (t = 0) and top (t = 1); those that meet the row are an interval of t, and
/// the sides are linear in t.
Columns CylinderOutline::columns(int row) const {
  const Columns all = {whole_.x, whole_.x + whole_.width};
  if (!is_hull_) return all;
  const auto between = [](int a, int b, double t) { return a + t * (b - a); };
  const double slope_up = top_.y - base_.y, slope_down = slope_up + top_.height - base_.height;
  double from = 0.0, to = 1.0;
  limit(base_.y - row - 1, slope_up, from, to);                // upper side above the row's lower border
  limit(row - base_.y - base_.height, -slope_down, from, to);  // lower side below the row's upper border
  if (from > to) return {};
  const auto left = [&](double t) { return between(base_.x, top_.x, t); };
  const auto right = [&](double t) { return between(base_.x + base_.width, top_.x + top_.width, t); };
  return {std::max(all.begin, static_cast<int>(std::floor(std::min(left(from), left(to))))),
          std::min(all.end, static_cast<int>(std::ceil(std::max(right(from), right(to)))))};
}

BoxOutline::BoxOutline(const SolidBox& box, const scene::Camera& camera, double depth_min)
    : window_(view_window({{}, {}, {box}}, SeenBodies::bin_and_tubes, camera, depth_min)) {}

SphereOutline::SphereOutline(const SolidSphere& sphere, const scene::Camera& camera, double depth_min)
    : window_(window_of(sphere, camera, depth_min)) {}

}  // namespace tubebin::scan
