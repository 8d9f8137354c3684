/// The contact forces of one step: projected Gauss-Seidel as in ODE's quickstep, but started from the last step's forces
/// (Catto 2005, "Iterative Dynamics with Temporal Coherence") and iterated until it has converged. What one step leaves
/// undone the next ones finish, so that a pile that stands still ends with forces that balance it, however deep it is.
#pragma once

#include <vector>

#include "physics/collision.hpp"
#include "tubebin/physics/drop_simulator.hpp"

namespace tubebin::physics {

/// In place of a tube's index: the bin.
constexpr std::size_t kBinBody = static_cast<std::size_t>(-1);

/// A touch in one step of the simulation, and what it bears.
struct StepContact {
  std::size_t first = kBinBody;
  std::size_t second = 0;
  Touch touch;
  double friction = 0.0;           ///< Coulomb coefficient
  Vec3 force = Vec3::Zero();       ///< N, on the second body at the touch; its opposite acts on the first
  Vec3 resistance = Vec3::Zero();  ///< N m, against rolling, on the second body; its opposite acts on the first
};

/// A tube as its contacts see it.
struct SolverBody {
  Vec3 velocity = Vec3::Zero();       ///< m/s, of the centre of mass
  Vec3 turn_velocity = Vec3::Zero();  ///< rad/s
  Vec3 center = Vec3::Zero();         ///< of mass, metres, world frame
  double inverse_mass = 0.0;
  Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero();  ///< world axes
};

/// Finds the forces with which no contact approaches beyond its layer, friction lies within its cone, and resistance to
/// rolling within a ball of rolling_resistance times the normal force. `bodies` have the velocities that they would have
/// at the step's end without contacts. The contacts' forces are where it starts from, and what it found. Iterates until
/// no relative velocity at a contact changes by more than solver_tolerance, at most solver_iterations times.
void solve_contacts(const PhysicsOptions& options, double time_step, std::vector<SolverBody> bodies,
                    std::vector<StepContact>& contacts);

}  // namespace tubebin::physics
