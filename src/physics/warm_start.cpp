#include "physics/warm_start.hpp"

#include <algorithm>
#include <utility>

namespace tubebin::physics {
namespace {

/// In the order of contacts; the bin comes before all tubes.
std::pair<std::size_t, std::size_t> bodies(const StepContact& contact) { return {contact.second, contact.first + 1}; }

}  // namespace

const StepContact* WarmStart::take(const StepContact& contact, double reach) {
  constexpr double kSameDirection = 0.9;  // cosine
  while (begin_ < before_.size() && bodies(before_[begin_]) < bodies(contact)) ++begin_;
  for (std::size_t i = begin_; i < before_.size() && bodies(before_[i]) == bodies(contact); ++i) {
    const StepContact& old = before_[i];
    if (taken_[i]) continue;
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

}  // namespace tubebin::physics
