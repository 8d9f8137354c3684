#include "modeling/point_labels.hpp"

#include <algorithm>
#include <cmath>

#include "modeling/labeling.hpp"

namespace tubebin::modeling {
namespace {

/// Whether the point may be of the tube's surface: within half a radius, beyond which are bridges' errors and strays.
bool is_about(const NearestSurface& nearest, const std::vector<TubeModel>& tubes) {
  return nearest.surface != NearestSurface::kNone &&
         std::abs(double(nearest.distance)) < tubes[nearest.surface].radius / 2.0;
}

double standard_deviation(const std::vector<NearestSurface>& nearest, const std::vector<TubeModel>& tubes) {
  double squares = 0.0, count = 0.0;
  for (const NearestSurface& n : nearest)
    if (is_about(n, tubes)) squares += double(n.distance) * double(n.distance), count += 1.0;
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

/// The nearest tube of each point, in `surface`.
std::vector<NearestSurface> nearest_tubes(std::span<const cloud::Point> points, const std::vector<TubeModel>& tubes,
                                          const Reach& reach) {
  std::vector<TubeSurface> surfaces;
  std::vector<std::uint32_t> tube_of_surface;
  for (std::uint32_t t = 0; t < tubes.size(); ++t)
    for (const TubePath& path : tubes[t].paths) {
      surfaces.push_back({.nodes = path.nodes, .radius = tubes[t].radius, .bridged = &path.bridged});
      tube_of_surface.push_back(t);
    }
  auto nearest = nearest_surfaces(points, surfaces, reach);
  for (NearestSurface& n : nearest)
    if (n.surface != NearestSurface::kNone) n.surface = tube_of_surface[n.surface];
  return nearest;
}

/// Points about a tube lie on its surface; of points that happen to be somewhere within half a radius, two fifths lie in
/// the nearest two fifths. True if any tube went.
bool drop_tubes_of_chance(std::vector<TubeModel>& tubes, const std::vector<NearestSurface>& nearest) {
  std::vector<double> points(tubes.size(), 0.0), on_surface(tubes.size(), 0.0);
  for (const NearestSurface& n : nearest) {
    if (!is_about(n, tubes)) continue;
    points[n.surface] += 1.0;
    if (std::abs(double(n.distance)) < tubes[n.surface].radius / 5.0) on_surface[n.surface] += 1.0;
  }
  std::size_t index = 0;
  return std::erase_if(tubes, [&](const TubeModel&) {
           const bool is_chance = on_surface[index] < 0.6 * points[index];
           ++index;
           return is_chance;
         }) > 0;
}

cloud::Label label_of(const NearestSurface& nearest) {
  return nearest.surface == NearestSurface::kNone ? 0 : nearest.surface + 1;
}

std::vector<cloud::Label> labels_of(const std::vector<NearestSurface>& nearest) {
  std::vector<cloud::Label> labels(nearest.size());
  std::ranges::transform(nearest, labels.begin(), label_of);
  return labels;
}

/// Whether the side of the tube that the point lies on is turned to the viewpoint. Ends, flat or round, are turned anywhere.
bool is_turned_to(const Vec3& viewpoint, const Vec3& point, const TubeModel& tube) {
  const auto distance = [&](const TubePath& path) { return distance_to_polyline(point, path.nodes); };
  const std::vector<Vec3>& nodes = std::ranges::min_element(tube.paths, {}, distance)->nodes;
  const Vec3 center = nearest_on_polyline(point, nodes);
  const bool is_at_end = std::min((center - nodes.front()).norm(), (center - nodes.back()).norm()) < tube.radius;
  return is_at_end || (point - center).dot(viewpoint - point) > 0.0;
}

/// Half a radius is what a bridge's guessed course may be off, as much again what a scanner strews about an edge. Where a
/// tube is seen, two fifths of a radius are far more than fits are off, but at corners, and keep clear of what it lies on; a fifth
/// is more than fits are off elsewhere, and keeps clear of rough ground.
Reach reach_of(const std::vector<TubeModel>& tubes, const Background& background) {
  const double least = tubes.empty() ? 1.0 : std::ranges::min_element(tubes, {}, &TubeModel::radius)->radius;
  return {.seen = std::clamp(5.0 * background.noise / least, background.is_rough ? 0.2 : 0.4, 1.0),
          .end = 1.0,
          .bridged = 1.0};
}

}  // namespace

PointLabels label_points(std::span<const cloud::Point> points, std::vector<TubeModel>& tubes,
                         const Background& background) {
  auto nearest = nearest_tubes(points, tubes, reach_of(tubes, background));
  if (drop_tubes_of_chance(tubes, nearest)) nearest = nearest_tubes(points, tubes, reach_of(tubes, background));
  return {.labels = labels_of(nearest), .noise = standard_deviation(nearest, tubes)};
}

std::vector<cloud::Label> label_further_points(std::span<const cloud::Point> points,
                                               const std::vector<TubeModel>& tubes, const Background& background) {
  return labels_of(nearest_tubes(points, tubes, reach_of(tubes, background)));
}

std::vector<cloud::Label> label_set_aside(std::span<const cloud::Point> points, const std::vector<TubeModel>& tubes,
                                          double noise, const ViewProjection& projection,
                                          std::span<const cloud::Point> viewpoints) {
  const auto nearest = nearest_tubes(points, tubes, {.seen = 0.2, .end = 0.2, .bridged = 0.2});
  std::vector<cloud::Label> labels(points.size(), 0);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const NearestSurface& n = nearest[k];
    if (n.surface == NearestSurface::kNone) continue;
    const TubeModel& tube = tubes[n.surface];
    const bool is_on = std::abs(double(n.distance)) < 3.0 * noise + 0.02 * tube.radius;
    const cloud::Point& viewpoint = viewpoint_of(k, viewpoints, projection);
    if (is_on && is_turned_to(viewpoint.cast<double>(), points[k].cast<double>(), tube)) labels[k] = label_of(n);
  }
  return labels;
}

}  // namespace tubebin::modeling
