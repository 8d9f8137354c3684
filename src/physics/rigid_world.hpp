/// ODE with the tubes as rigid bodies, which move under the forces of our contacts; the bin stands still.
#pragma once

#include <memory>
#include <vector>

#include "physics/contact_solver.hpp"
#include "tubebin/physics/drop_simulator.hpp"

namespace tubebin::physics {

struct PileForces {
  std::vector<StepContact> contacts;  ///< of the last step, in its order
};

class RigidWorld {
 public:
  /// Tubes that stand still, under no forces or under those of an earlier world with the same tubes in the same places,
  /// whose masses are known, too: they take longer than some steps.
  RigidWorld(const std::vector<scene::PlacedTube>& tubes, const scene::Bin& bin, const PhysicsOptions& options,
             PileForces forces = {}, std::vector<tube::MassProperties> masses = {});
  ~RigidWorld();
  RigidWorld(RigidWorld&&) noexcept;
  RigidWorld(const RigidWorld&) = delete;
  RigidWorld& operator=(const RigidWorld&) = delete;

  void step(double time_step);  ///< seconds

  /// Walls that nobody sees, smooth, on the bin's walls up to `height` (metres): what falls can't leave the bin.
  void raise_guards(double height);
  void remove_guards();
  bool has_guards() const;
  /// Of tubes at rest, those in no chain of contacts with this one stand still from now on, proven to be at rest as they
  /// are, until something touches them or what they touch.
  void let_sleep_beyond(std::size_t tube);
  /// Holds a tube from now on, without turning, and moves it straight up (m/s). It passes through the bin.
  void pull(std::size_t tube, double speed);
  /// Takes the pulled tube away; the indices of those after it are one less. The others keep their forces.
  void remove_pulled();
  /// N, upward, that held the pulled tube over the last step: its weight and what its contacts weigh on it.
  double pulling_force() const;
  /// Whether a tube touched, or nearly, another one in the last step.
  bool touches_another(std::size_t tube) const;
  /// Moves a tube to where it is to fall from.
  void put(std::size_t tube, const Pose& world_from_tube);

  /// Of the last step.
  PileForces forces() const;
  const std::vector<scene::PlacedTube>& tubes() const;
  const std::vector<tube::MassProperties>& masses() const;
  /// World pose of one tube's frame.
  Pose pose(std::size_t tube) const;
  scene::Box bounds(std::size_t tube) const;  ///< world frame
  Vec3 center_of_mass(std::size_t tube) const;
  double speed(std::size_t tube) const;      ///< m/s, of the centre of mass
  double turn_rate(std::size_t tube) const;  ///< rad/s
  std::size_t size() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tubebin::physics
