/// One step of emptying a bin: how a pile came from the one before.
#pragma once

#include <vector>

#include "tubebin/scene/scene.hpp"

namespace tubebin::scene {

struct MovedTube {
  std::uint32_t label = 0;
  double distance = 0.0;  ///< metres, of the node that moved farthest

  friend bool operator==(const MovedTube&, const MovedTube&) = default;
};

/// A tube was lifted out. Labels of the others are those that they have now.
struct Lift {
  std::uint32_t lifted = 0;  ///< its label in the pile before
  double force = 0.0;        ///< N; the most that pulled for a tenth of a second, the weight included
  std::vector<std::uint32_t>
      given_up;  ///< labels in the pile before of those lifted first, without which the others did
                 ///< not come to rest; in their order
  std::vector<std::uint32_t> dragged;  ///< tubes that rose meanwhile by more than their radius, ascending
  std::vector<MovedTube> moved;        ///< tubes that lie elsewhere by more than kMovedLeast, ascending

  friend bool operator==(const Lift&, const Lift&) = default;
};

constexpr double kMovedLeast = 0.0005;  ///< metres; as little as tubes at rest may creep

/// The pile before without the tube of that label.
std::vector<PlacedTube> without(std::vector<PlacedTube> pile, std::uint32_t label);

/// Which of the same tubes moved.
std::vector<MovedTube> find_moved(const std::vector<PlacedTube>& before, const std::vector<PlacedTube>& after);

}  // namespace tubebin::scene
