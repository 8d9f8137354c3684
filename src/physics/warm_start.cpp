#include "physics/warm_start.hpp"

#include <algorithm>

namespace tubebin {

const StepContact* WarmStart::take(const StepContact& contact, double reach) {
  constexpr double kSameDirection = 0.9;  // cosine
  for (std::size_t i = 0; i < before_.size(); ++i) {
    const StepContact& old = before_[i];
    if (taken_[i] || old.first != contact.first || old.second != contact.second) continue;
    if ((old.touch.position - contact.touch.position).squaredNorm() > reach * reach) continue;
    if (old.touch.normal.dot(contact.touch.normal) < kSameDirection) continue;
    taken_[i] = true;
    return &old;
  }
  return nullptr;
}

ContactLoad WarmStart::start(StepContact& contact, double share, double reach, bool resting) {
  const StepContact* old = take(contact, reach);
  if (!old) return {};
  contact.normal_force_before = old->normal_force;
  if (!resting || old->normal_force <= 0.0) return {};
  const double lasting = std::clamp(old->normal_force_before / old->normal_force, 0.0, 1.0);
  const double scale = share * lasting;
  return {scale * old->load.force_on_second, scale * old->load.torque_on_first, scale * old->load.torque_on_second};
}

}  // namespace tubebin
