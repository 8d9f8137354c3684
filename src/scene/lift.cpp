#include "tubebin/scene/lift.hpp"

#include <algorithm>

namespace tubebin::scene {

std::vector<PlacedTube> without(std::vector<PlacedTube> pile, std::uint32_t label) {
  pile.erase(pile.begin() + static_cast<std::ptrdiff_t>(label) - 1);
  return pile;
}

std::vector<MovedTube> find_moved(const std::vector<PlacedTube>& before, const std::vector<PlacedTube>& after) {
  std::vector<MovedTube> moved;
  for (std::size_t k = 0; k < after.size(); ++k) {
    double farthest = 0.0;
    for (int node = 0; node < static_cast<int>(after[k].tube.nodes.size()); ++node)
      farthest = std::max(farthest, (after[k].node_in_world(node) - before[k].node_in_world(node)).norm());
    if (farthest > kMovedLeast) moved.push_back({static_cast<std::uint32_t>(k + 1), farthest});
  }
  return moved;
}

}  // namespace tubebin::scene
