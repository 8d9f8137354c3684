/// Which pieces of two tubes may touch, kept over the steps in which the tubes hardly move (Verlet 1967, "Computer
/// experiments on classical fluids", has the idea: neighbours are listed a little beyond reach).
#pragma once

#include <vector>

#include "physics/collision.hpp"

namespace tubebin::physics {

class NearPieces {
 public:
  /// Brings the lists up to date with where the tubes are.
  void follow(const std::vector<CollisionTube>& tubes);

  /// Of tubes `first` < `second`: every pair of pieces that touch, and some more.
  const std::vector<PiecePair>& pairs(std::size_t first, std::size_t second) const {
    return pairs_[second * (second - 1) / 2 + first];
  }

 private:
  std::vector<std::vector<PiecePair>> pairs_;
  std::vector<std::vector<Vec3>> nodes_when_listed_;  ///< of each tube
};

}  // namespace tubebin::physics
