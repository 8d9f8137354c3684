/// ODE, with the tubes as rigid bodies and the bin standing still.
#pragma once

#include <memory>
#include <vector>

#include "physics/collision.hpp"
#include "tubebin/physics/drop_simulator.hpp"

namespace tubebin::physics {

/// How one step is taken.
struct StepSettings {
  double time_step = 0.0;     ///< seconds
  int solver_iterations = 0;  ///< of quickstep
  double warm_start = 0.0;    ///< share of a resting contact's force that the step starts from
};
/// Those of tubes that move.
StepSettings step_settings(const PhysicsOptions& options);

class RigidWorld {
 public:
  RigidWorld(const std::vector<scene::PlacedTube>& tubes, const scene::Bin& bin, const PhysicsOptions& options,
             std::uint64_t seed);
  ~RigidWorld();
  RigidWorld(const RigidWorld&) = delete;
  RigidWorld& operator=(const RigidWorld&) = delete;

  void step(const StepSettings& settings);

  const std::vector<scene::PlacedTube>& tubes() const;
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

}  // namespace tubebin::physics
