/// Contact forces of one step as the start of the next one's solution. ODE's quickstep starts from none, so that a
/// pile that stands still is solved from nothing again in every step.
///
/// A share s of a resting contact's force f acts as an outer force of the next step, and the solver adds the rest. At
/// rest that rest is (1 - s) f, so what the solver leaves undone shrinks by 1 - s, and since friction and rolling
/// resistance are limited by the normal force in the share as well as in the rest, so are they in the sum.
#pragma once

#include <vector>

#include "physics/collision.hpp"

namespace tubebin::physics {

/// In place of a tube's index: the bin.
constexpr std::size_t kBinBody = static_cast<std::size_t>(-1);

/// What a contact does to its two bodies, the torques about their centres of mass. The force on the first body is the
/// opposite of that on the second.
struct ContactLoad {
  Vec3 force_on_second = Vec3::Zero();
  Vec3 torque_on_first = Vec3::Zero();
  Vec3 torque_on_second = Vec3::Zero();
};

/// A touch in one step of the simulation.
struct StepContact {
  std::size_t first = kBinBody;
  std::size_t second = 0;
  Touch touch;
  ContactLoad load{};                ///< of this step, once it is solved
  double normal_force = 0.0;         ///< N, of this step's load
  double normal_force_before = 0.0;  ///< N, of the step before
};

/// This step's contacts take over what they know of the step `before`; each of those is taken once. In both steps they
/// come by their second body, those of one by the first.
class WarmStart {
 public:
  explicit WarmStart(std::vector<StepContact> before) : before_(std::move(before)), taken_(before_.size(), false) {}

  /// The load that `contact` starts from: none where it is new or not `resting`, else the `share` of the last step's.
  /// An impact lasts a step: what exceeds the force of the step before it is not taken over. `reach` (metres) is how
  /// far a contact may have moved. Sets contact.normal_force_before.
  ContactLoad start(StepContact& contact, double share, double reach, bool resting);

 private:
  const StepContact* take(const StepContact& contact, double reach);

  std::vector<StepContact> before_;
  std::vector<bool> taken_;
  std::size_t begin_ = 0;  ///< of those that are not of bodies before the last contact's
};

}  // namespace tubebin::physics
