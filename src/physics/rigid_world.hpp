/// ODE, with the tubes as rigid bodies and the bin standing still.
#pragma once

#include <memory>
#include <vector>

#include "physics/collision.hpp"
#include "tubebin/physics/drop_simulator.hpp"

namespace tubebin {

/// Steps of options.time_step that take at least as long as `seconds`.
int steps_in(double seconds, const PhysicsOptions& options);

class RigidWorld {
 public:
  RigidWorld(const std::vector<PlacedTube>& tubes, const Bin& bin, const PhysicsOptions& options, std::uint64_t seed);
  ~RigidWorld();
  RigidWorld(const RigidWorld&) = delete;
  RigidWorld& operator=(const RigidWorld&) = delete;

  /// In place of options.solver_iterations.
  void set_solver_iterations(int iterations);
  /// From now on contacts start from no forces.
  void stop_warm_starts();
  /// One step of options.time_step.
  void step();

  const std::vector<PlacedTube>& tubes() const;
  /// World pose of one tube's frame.
  Pose pose(std::size_t tube) const;
  Vec3 center_of_mass(std::size_t tube) const;
  double speed(std::size_t tube) const;      ///< m/s, of the centre of mass
  double turn_rate(std::size_t tube) const;  ///< rad/s
  std::size_t size() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tubebin
