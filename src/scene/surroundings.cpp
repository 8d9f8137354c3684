#include "tubebin/scene/scene.hpp"

namespace tubebin::scene {
namespace {

constexpr Limits kPlacesRead = {-1000.0, 1000.0};
constexpr Limits kSizesRead = {1e-6, 1000.0};
constexpr Limits kTurnsRead = {-360.0, 360.0};

Pose upright_pose(const Vec3& position, double yaw_deg) {
  return make_pose(Quat(Eigen::AngleAxisd(radians(yaw_deg), Vec3::UnitZ())), position);
}

BinPart part_of(const StandingBox& standing) {
  const Vec3 half(standing.size.x() / 2.0, standing.size.y() / 2.0, 0.0);
  const Box box(-half, half + standing.size.z() * Vec3::UnitZ());
  return {.box = box, .world_from_part = upright_pose(standing.position, standing.yaw_deg), .is_turned = true};
}

}  // namespace

std::vector<BinPart> surrounding_boxes(const Scene& scene) {
  if (!scene.surroundings) return {};
  std::vector<BinPart> parts = {part_of(scene.surroundings->table)};
  for (const StandingBox& box : scene.surroundings->boxes) parts.push_back(part_of(box));
  for (const StandingBin& bin : scene.surroundings->bins)
    for (BinPart part : bin_parts(scene.bin)) {
      part.world_from_part = upright_pose(bin.position, bin.yaw_deg) * part.world_from_part;
      part.is_turned = true;
      parts.push_back(part);
    }
  return parts;
}

std::vector<StandingCylinder> surrounding_cylinders(const Scene& scene) {
  return scene.surroundings ? scene.surroundings->cylinders : std::vector<StandingCylinder>{};
}

void describe(Fields& fields, StandingBox& box) {
  fields.vector("position", box.position, kPlacesRead, "m", "of the middle of its lower face");
  fields.number("yaw_deg", box.yaw_deg, kTurnsRead, "degrees", "about z");
  fields.vector("size", box.size, kSizesRead, "m", "along its own axes");
}

void describe(Fields& fields, StandingCylinder& cylinder) {
  fields.vector("position", cylinder.position, kPlacesRead, "m", "of the middle of its lower face");
  fields.number("radius", cylinder.radius, kSizesRead, "m", "");
  fields.number("height", cylinder.height, kSizesRead, "m", "");
}

void describe(Fields& fields, StandingBin& bin) {
  fields.vector("position", bin.position, kPlacesRead, "m", "of the centre of its floor");
  fields.number("yaw_deg", bin.yaw_deg, kTurnsRead, "degrees", "about z");
}

void describe(Fields& fields, Surroundings& surroundings) {
  fields.group("table", "the bin and all else stand on it",
               [&](Fields& inner) { describe(inner, surroundings.table); });
  fields.list("boxes", surroundings.boxes, "on the table");
  fields.list("cylinders", surroundings.cylinders, "on the table");
  fields.list("bins", surroundings.bins, "empty, of the form of the bin with the tubes");
}

}  // namespace tubebin::scene
