#include "physics/near_pieces.hpp"

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

void NearPieces::follow(const std::vector<CollisionTube>& tubes) {
  const bool is_new = nodes_when_listed_.empty();
  nodes_when_listed_.resize(tubes.size());
  pairs_.resize(tubes.size() * (tubes.size() - 1) / 2);
  std::vector<bool> moved(tubes.size());
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    moved[i] = is_new || have_moved(tubes[i].nodes, nodes_when_listed_[i]);
    if (moved[i]) nodes_when_listed_[i] = tubes[i].nodes;
  }
  for (std::size_t second = 1; second < tubes.size(); ++second)
    for (std::size_t first = 0; first < second; ++first) {
      if (!moved[first] && !moved[second]) continue;
      std::vector<PiecePair>& pairs = pairs_[second * (second - 1) / 2 + first];
      pairs.clear();
      find_near_pieces(tubes[first], tubes[second], kReach, pairs);
    }
}

}  // namespace tubebin::physics
