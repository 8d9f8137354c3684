#include "modeling/fitting/rough_ground.hpp"

#include "modeling/fitting/centerline_fitting.hpp"
#include "modeling/fitting/piece_evidence.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {

std::vector<char> find_ground(const std::vector<VoteCurve>& curves, double radius, const OcclusionTest& occlusion) {
  const double tolerance = bend_tolerance(curves, radius);
  return map_in_parallel(curves.size(), [&](std::size_t k) -> char {
    return goes_on_beside(outline_along(first_nodes(curves[k], tolerance, radius), radius, occlusion));
  });
}

bool is_rough(const std::vector<VoteCurve>& curves, const std::vector<char>& is_ground, std::size_t sampled) {
  constexpr double kLeastOutlined = 1.0 / 3.0;
  if (sampled < kPointsOfGround) return false;
  std::size_t outlined = 0;
  for (std::size_t k = 0; k < curves.size(); ++k)
    if (!is_ground[k]) outlined += curves[k].points.size();
  return static_cast<double>(outlined) < kLeastOutlined * static_cast<double>(sampled);
}

void drop_ground(std::vector<VoteCurve>& curves, const std::vector<char>& is_ground) {
  std::size_t next = 0;
  std::erase_if(curves, [&](const VoteCurve&) { return is_ground[next++] != 0; });
}

bool drop_rough_ground(std::vector<VoteCurve>& curves, std::size_t sampled, double radius,
                       const OcclusionTest& occlusion) {
  if (sampled < kPointsOfGround) return false;  // most clouds need no outlines
  const std::vector<char> is_ground = find_ground(curves, radius, occlusion);
  if (!is_rough(curves, is_ground, sampled)) return false;
  drop_ground(curves, is_ground);
  return true;
}

}  // namespace tubebin::modeling
