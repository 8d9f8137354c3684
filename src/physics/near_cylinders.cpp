#include "physics/near_cylinders.hpp"

#include <algorithm>

namespace tubebin::physics {
namespace {

/// A tube whose nodes are farther than this from where they were listed is listed anew (metres).
constexpr double kMovementMax = 0.002;

/// Of two tubes the one listed anew moves by kMovementMax at most until the next time. The other may be as far from its
/// own listing on one side now and on the other side then.
constexpr double kReach = 3.0 * kMovementMax;

bool have_moved(const std::vector<Vec3>& nodes, const std::vector<Vec3>& when_listed) {
  return !std::equal(nodes.begin(), nodes.end(), when_listed.begin(), [](const Vec3& now, const Vec3& then) {
    return (now - then).squaredNorm() <= kMovementMax * kMovementMax;
  });
}

}  // namespace

void NearCylinders::follow(const std::vector<CollisionTube>& tubes, const std::vector<double>& margins) {
  const bool is_new = nodes_when_listed_.empty();
  nodes_when_listed_.resize(tubes.size());
  near_.resize(tubes.size());
  std::vector<bool> moved(tubes.size());
  std::vector<std::size_t> all_before, moved_before;  // of the tubes before `second`
  for (std::size_t second = 0; second < tubes.size(); ++second) {
    const std::vector<Vec3>& nodes = tubes[second].nodes;
    moved[second] = is_new || have_moved(nodes, nodes_when_listed_[second]);
    std::vector<NearTube>& near = near_[second];
    std::erase_if(near, [&](const NearTube& other) { return moved[second] || moved[other.first]; });
    for (const std::size_t first : moved[second] ? all_before : moved_before) {
      NearTube other{first, {}};
      find_near_cylinders(tubes[first], tubes[second], kReach + std::max(margins[first], margins[second]),
                          other.cylinders);
      if (!other.cylinders.empty()) near.push_back(std::move(other));
    }
    std::sort(near.begin(), near.end(), [](const NearTube& a, const NearTube& b) { return a.first < b.first; });
    all_before.push_back(second);
    if (!moved[second]) continue;
    moved_before.push_back(second);
    nodes_when_listed_[second] = nodes;
  }
}

}  // namespace tubebin::physics
