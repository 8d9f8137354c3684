/// Which cylinders of two tubes may touch, kept over the steps in which the tubes hardly move (Verlet 1967, "Computer
/// experiments on classical fluids", has the idea: neighbours are listed a little beyond reach).
#pragma once

#include <vector>

#include "physics/collision.hpp"

namespace tubebin::physics {

/// A tube near another one, and every pair of their cylinders that touch, and some more.
struct NearTube {
  std::size_t first = 0;
  std::vector<CylinderPair> cylinders;
};

class NearCylinders {
 public:
  /// Brings the lists up to date with where the tubes are, each of which has a touch where it comes within its margin
  /// (metres): beyond kMovementMax only where it moves as far in a step.
  void follow(const std::vector<CollisionTube>& tubes, const std::vector<double>& margins);

  /// The tubes before `second` that may touch it, in order.
  const std::vector<NearTube>& near(std::size_t second) const { return near_[second]; }

 private:
  std::vector<std::vector<NearTube>> near_;           ///< of each tube
  std::vector<std::vector<Vec3>> nodes_when_listed_;  ///< of each tube
};

}  // namespace tubebin::physics
