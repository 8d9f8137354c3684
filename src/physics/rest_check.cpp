#include "physics/rest_check.hpp"

#include <algorithm>
#include <cmath>

namespace tubebin::physics {

bool all_below(const RigidWorld& world, double speed, double turn_rate, std::optional<std::size_t> except) {
  for (std::size_t i = 0; i < world.size(); ++i)
    if (i != except && !(world.speed(i) < speed && world.turn_rate(i) < turn_rate)) return false;
  return true;
}

bool is_slow(const RigidWorld& world, const PhysicsOptions& options) {
  return all_below(world, options.rest_speed, options.rest_turn_rate);
}

namespace {

/// Beside the bounds or below them.
std::optional<std::size_t> find_beyond(const RigidWorld& world, const scene::Box& bounds) {
  for (std::size_t i = 0; i < world.size(); ++i) {
    Vec3 center = world.center_of_mass(i);
    center.z() = std::min(center.z(), bounds.max().z());
    if (!bounds.contains(center)) return i;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::size_t> find_outside(const RigidWorld& world, const scene::Bin& bin) {
  if (bin.has_mesh()) return find_beyond(world, scene::bin_bounds(bin));
  const std::vector<scene::InnerFace> faces = scene::inner_faces(bin);
  for (std::size_t i = 0; i < world.size(); ++i) {
    Vec3 center = world.center_of_mass(i);
    center.z() = std::min(center.z(), bin.height);
    const bool outside =
        std::ranges::any_of(faces, [&](const scene::InnerFace& face) { return face.depth_inside(center) <= 0.0; });
    if (outside) return i;
  }
  return std::nullopt;
}

double deepest_penetration(const std::vector<scene::Contact>& contacts) {
  double deepest = 0.0;
  for (const scene::Contact& contact : contacts) deepest = std::max(deepest, contact.depth);
  return deepest;
}

std::optional<std::size_t> find_floating(const std::vector<scene::Contact>& contacts, std::size_t tube_count) {
  std::vector<bool> held(tube_count + 1, false);
  held[0] = true;
  for (bool changed = true; changed;) {
    changed = false;
    for (const scene::Contact& contact : contacts) {
      if (held[contact.label_a] == held[contact.label_b]) continue;
      held[contact.label_a] = held[contact.label_b] = true;
      changed = true;
    }
  }
  const auto floating = std::find(held.begin(), held.end(), false);
  if (floating == held.end()) return std::nullopt;
  return static_cast<std::size_t>(floating - held.begin()) - 1;
}

}  // namespace tubebin::physics
