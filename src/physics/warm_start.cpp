#include "physics/warm_start.hpp"

namespace tubebin::physics {
namespace {

bool is_same_spot(const Touch& a, const Touch& b, double reach) {
  constexpr double kSameDirection = 0.9;  // cosine
  return (a.position - b.position).squaredNorm() <= reach * reach && a.normal.dot(b.normal) >= kSameDirection;
}

}  // namespace

std::pair<std::size_t, std::size_t> contact_bodies(const StepContact& contact) {
  return {contact.second, contact.first + 1};
}

void warm_start(const std::vector<StepContact>& before, double share, const std::vector<CollisionTube>& tubes,
                std::vector<StepContact>& contacts) {
  std::vector<bool> taken(before.size(), false);
  std::size_t begin = 0;  // of those that are not of bodies before this contact's
  for (StepContact& contact : contacts) {
    const double reach = 0.5 * tubes[contact.second].radius;
    while (begin < before.size() && contact_bodies(before[begin]) < contact_bodies(contact)) ++begin;
    for (std::size_t i = begin; i < before.size() && contact_bodies(before[i]) == contact_bodies(contact); ++i) {
      if (taken[i] || !is_same_spot(before[i].touch, contact.touch, reach)) continue;
      taken[i] = true;
      contact.force = share * before[i].force;
      contact.resistance = share * before[i].resistance;
      break;
    }
  }
}

}  // namespace tubebin::physics
