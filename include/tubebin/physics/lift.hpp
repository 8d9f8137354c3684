/// Takes a tube out of a pile at rest, as a bin is emptied one by one.
#pragma once

#include "tubebin/physics/drop_simulator.hpp"

namespace tubebin::physics {

struct LiftOptions {
  double speed = 0.1;  ///< m/s

  friend bool operator==(const LiftOptions&, const LiftOptions&) = default;
};

struct LiftResult {
  DropResult rest;     ///< of the tubes that stay, in their order
  double force = 0.0;  ///< N; the most that pulled for a tenth of a second, the tube's weight included
  std::vector<std::size_t>
      dragged;  ///< indices, from 0, of tubes that stay and rose by more than their radius meanwhile
};

/// Pulls a tube of a pile at rest slowly straight up, as a gripper that holds it without turning, until nothing is in its
/// way or all of it is above the rim. Then it is gone; the others come to rest from where they are, as after a drop.
/// Of `pile` it takes the tubes and the forces; where there are none, they are found while it pulls.
LiftResult lift_tube(const DropResult& pile, std::size_t tube, const scene::Bin& bin, const PhysicsOptions& options,
                     const LiftOptions& lift, std::uint64_t seed);

}  // namespace tubebin::physics
