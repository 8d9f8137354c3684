#include "physics/spawn.hpp"

#include <limits>
#include <utility>

#include "physics/collision.hpp"

namespace tubebin::physics {
namespace {

constexpr int kOrientationTries = 1000;

scene::Box bounds_of(const tube::Tube& tube, const Quat& rotation) {
  scene::Box bounds;
  for (const Vec3& node : tube.nodes) bounds.extend(rotation * node);
  return {bounds.min() - Vec3::Constant(tube.radius_max()), bounds.max() + Vec3::Constant(tube.radius_max())};
}

bool fits_between_walls(const scene::Box& bounds, const scene::Bin& bin, double clearance) {
  return bounds.sizes().x() + 2.0 * clearance <= bin.length && bounds.sizes().y() + 2.0 * clearance <= bin.width;
}

std::optional<Quat> fitting_rotation(const tube::Tube& tube, const scene::Bin& bin, double clearance, Random& random) {
  Quat rotation = Quat::Identity();
  for (int i = 0; i < kOrientationTries; ++i) {
    if (fits_between_walls(bounds_of(tube, rotation), bin, clearance)) return rotation;
    rotation = random.rotation();
  }
  return std::nullopt;
}

/// How far from the bin's middle a tube may start, as a share of the room between the walls: one that stands taller
/// than the walls falls over, and from beside a wall it would fall out.
double steadiness(const scene::Box& bounds, const scene::Bin& bin) {
  return std::min(1.0, bin.height / bounds.sizes().z());
}

bool overlaps(const CollisionTube& shape, const std::vector<CollisionTube>& placed, double clearance) {
  std::vector<Touch> touches;
  for (const CollisionTube& other : placed) {
    collide(shape, other, -clearance, touches);
    if (!touches.empty()) return true;
  }
  return false;
}

CollisionTube moved(CollisionTube shape, const Vec3& by) {
  for (CollisionCylinder& cylinder : shape.cylinders) {
    cylinder.axis = {cylinder.axis.a + by, cylinder.axis.b + by};
    cylinder.bounds.translate(by);
  }
  for (Ball& joint : shape.joints) joint.center += by;
  shape.bounds.translate(by);
  return shape;
}

/// The shape at the lowest height, in steps of a radius from where it is, at which it is free and all of it is below
/// `top_max`; and how far that is. Nothing where there is none.
std::optional<std::pair<CollisionTube, double>> raised_until_free(const CollisionTube& shape,
                                                                  const std::vector<CollisionTube>& placed,
                                                                  double clearance, double top_max) {
  for (double height = 0.0; shape.bounds.max().z() + height < top_max; height += shape.radius) {
    CollisionTube raised = moved(shape, {0.0, 0.0, height});
    if (!overlaps(raised, placed, clearance)) return std::pair{std::move(raised), height};
  }
  return std::nullopt;
}

/// Of several random places the lowest free one above the rim.
Pose lowest_free_pose(const tube::Tube& tube, const Quat& rotation, const std::vector<CollisionTube>& placed,
                      const scene::Bin& bin, const PhysicsOptions& options, Random& random) {
  const double clearance = options.spawn_clearance;
  const scene::Box bounds = bounds_of(tube, rotation);
  const Vec3 room =
      steadiness(bounds, bin) * (0.5 * (Vec3(bin.length, bin.width, 0.0) - bounds.sizes()) - Vec3::Constant(clearance));
  Pose lowest = Pose::Identity();
  double top_max = std::numeric_limits<double>::infinity();
  for (int i = 0; i < options.spawn_tries; ++i) {
    const double x = random.uniform(-room.x(), room.x());
    const double y = random.uniform(-room.y(), room.y());
    const Vec3 start(x - bounds.center().x(), y - bounds.center().y(), bin.height + clearance - bounds.min().z());
    const CollisionTube shape({tube, make_pose(rotation, start)});
    const auto raised = raised_until_free(shape, placed, clearance, top_max);
    if (!raised) continue;
    top_max = raised->first.bounds.max().z();
    lowest = make_pose(rotation, start + Vec3(0.0, 0.0, raised->second));
  }
  return lowest;
}

}  // namespace

std::optional<std::vector<scene::PlacedTube>> spawn(const std::vector<tube::Tube>& tubes, const scene::Bin& bin,
                                                    const PhysicsOptions& options, Random& random) {
  std::vector<scene::PlacedTube> spawned;
  std::vector<CollisionTube> placed;
  for (const tube::Tube& tube : tubes) {
    const std::optional<Quat> rotation = fitting_rotation(tube, bin, options.spawn_clearance, random);
    if (!rotation) return std::nullopt;
    spawned.push_back({tube, lowest_free_pose(tube, *rotation, placed, bin, options, random)});
    placed.emplace_back(spawned.back());
  }
  return spawned;
}

Pose spawn_again(std::size_t tube, const std::vector<scene::PlacedTube>& tubes, const scene::Bin& bin,
                 const PhysicsOptions& options, Random& random) {
  std::vector<CollisionTube> others;
  for (std::size_t i = 0; i < tubes.size(); ++i)
    if (i != tube) others.emplace_back(tubes[i]);
  const std::optional<Quat> rotation = fitting_rotation(tubes[tube].tube, bin, options.spawn_clearance, random);
  return lowest_free_pose(tubes[tube].tube, *rotation, others, bin, options, random);
}

}  // namespace tubebin::physics
