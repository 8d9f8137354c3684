#include "modeling/mixed_pixels.hpp"

#include <algorithm>
#include <cmath>

#include "modeling/input/neighborhoods.hpp"

namespace tubebin::modeling {
namespace {

/// Those without a label that lie alone among their like.
std::vector<std::uint32_t> lone_points(const FilteredCloud& cloud, const ViewProjection& projection,
                                       const std::vector<cloud::Label>& labels) {
  std::vector<std::uint32_t> unlabeled;
  std::vector<cloud::Point> points;
  for (std::uint32_t i = 0; i < labels.size(); ++i)
    if (labels[i] == 0) unlabeled.push_back(i), points.push_back(cloud.points[i]);
  if (points.empty()) return {};
  const std::vector<bool> alone = lie_alone(projection, points, cloud.spacing);
  std::vector<std::uint32_t> lone;
  for (std::size_t k = 0; k < unlabeled.size(); ++k)
    if (alone[k]) lone.push_back(unlabeled[k]);
  return lone;
}

/// A point's ray from its viewpoint.
struct Ray {
  Vec3 origin, direction;  ///< direction: unit
  double range = 0.0;      ///< of the point, metres
};

/// Where a ray comes nearest to a segment: how far along the ray, and how far off, metres.
struct Passage {
  double along = 0.0, off = 0.0;
};

Passage nearest_passage(const Ray& ray, const Vec3& start, const Vec3& end) {
  const Vec3 axis = end - start, from_start = ray.origin - start;
  const double slope = ray.direction.dot(axis), length_squared = axis.squaredNorm();
  const double across = length_squared - slope * slope;  // 0 where they are parallel
  const double ahead = from_start.dot(ray.direction), beside = from_start.dot(axis);
  const double t = across > 1e-12 * length_squared ? std::clamp((beside - slope * ahead) / across, 0.0, 1.0) : 0.0;
  const double along = (start + t * axis - ray.origin).dot(ray.direction);
  return {along, (ray.origin + along * ray.direction - start - t * axis).norm()};
}

/// The nearest tube whose edge the ray passes, within a spacing, before it comes to its point; 0 where none is.
cloud::Label tube_before(const Ray& ray, const std::vector<TubeModel>& tubes, double spacing) {
  cloud::Label label = 0;
  double nearest = ray.range;
  for (std::uint32_t t = 0; t < tubes.size(); ++t)
    for (const TubePath& path : tubes[t].paths)
      for (std::size_t k = 0; k + 1 < path.nodes.size(); ++k) {
        const Passage passage = nearest_passage(ray, path.nodes[k], path.nodes[k + 1]);
        if (passage.along > nearest || std::abs(passage.off - tubes[t].radius) > spacing) continue;
        nearest = passage.along;
        label = t + 1;
      }
  return label;
}

}  // namespace

void label_mixed_pixels(const FilteredCloud& cloud, const ViewProjection& projection,
                        const std::vector<TubeModel>& tubes, std::vector<cloud::Label>& labels) {
  for (const std::uint32_t i : lone_points(cloud, projection, labels)) {
    const cloud::Point& viewpoint = viewpoint_of(i, cloud.viewpoints, projection);
    const Vec3 offset = (cloud.points[i] - viewpoint).cast<double>();
    const Ray ray{.origin = viewpoint.cast<double>(), .direction = offset.normalized(), .range = offset.norm()};
    labels[i] = tube_before(ray, tubes, cloud.spacing);
  }
}

}  // namespace tubebin::modeling
