#include "modeling/path_ends.hpp"

#include "modeling/input/point_sample.hpp"
#include "modeling/labeling.hpp"

namespace tubebin::modeling {

PathEnd last_end(const std::vector<Vec3>& nodes, double radius) {
  const Vec3& tip = nodes.back();
  std::size_t k = nodes.size() - 2;
  while (k > 0 && (nodes[k] - tip).norm() < radius) --k;
  return {tip, (tip - nodes[k]).normalized()};
}

Segment points_without_label(std::span<const cloud::Label> labels) {
  Segment found;
  for (std::uint32_t i = 0; i < labels.size(); ++i)
    if (labels[i] == 0) found.push_back(i);
  return found;
}

Segment about_ends(const std::vector<TubeModel>& tubes, std::span<const cloud::Point> points, const Segment& indices,
                   const std::function<double(const TubeModel&)>& reach) {
  std::vector<TubeSurface> balls;
  for (const TubeModel& tube : tubes)
    for (const TubePath& path : tube.paths)
      for (const Vec3* tip : {&path.nodes.front(), &path.nodes.back()})
        balls.push_back({.nodes = {tip, 1}, .radius = reach(tube)});
  const std::vector<char> is_near = within_surfaces(points_at(points, indices), balls, 0.0);
  Segment found;
  for (std::size_t k = 0; k < indices.size(); ++k)
    if (is_near[k]) found.push_back(indices[k]);
  return found;
}

Segment near(const Vec3& place, double distance, std::span<const cloud::Point> points, const Segment& indices) {
  Segment found;
  for (const std::uint32_t i : indices)
    if ((points[i].cast<double>() - place).squaredNorm() < distance * distance) found.push_back(i);
  return found;
}

}  // namespace tubebin::modeling
