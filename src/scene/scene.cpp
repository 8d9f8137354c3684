#include "tubebin/scene/scene.hpp"

#include <cmath>

#include "scene/pixel_limit.hpp"

namespace tubebin::scene {

tube::TubeSolids PlacedTube::solids_in_world() const {
  std::vector<Vec3> nodes;
  for (const Vec3& node : tube.nodes) nodes.push_back(world_from_tube * node);
  return tube::tube_solids(tube, nodes);
}

Scene seen_from(const Scene& scene, std::size_t source) {
  return {.bin = scene.bin,
          .scanner = source == 0 ? scene.scanner : scene.further_scanners.at(source - 1),
          .tubes = scene.tubes,
          .surroundings = scene.surroundings};
}

Pose Scanner::world_from_scanner() const {
  Eigen::Matrix3d looking_down;  // columns: image right, image down, view, in world axes
  looking_down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const Eigen::Matrix3d turned = (Eigen::AngleAxisd(radians(rotation_deg.z()), Vec3::UnitZ()) *
                                  Eigen::AngleAxisd(radians(rotation_deg.y()), Vec3::UnitY()) *
                                  Eigen::AngleAxisd(radians(rotation_deg.x()), Vec3::UnitX()))
                                     .toRotationMatrix() *
                                 looking_down;
  Pose pose = Pose::Identity();
  pose.linear() = turned;
  pose.translation() = position;
  return pose;
}

Vec3 rotation_deg_towards(const Vec3& target, const Vec3& position) {
  const Vec3 view = target - position;
  const double horizontal = std::hypot(view.x(), view.y());
  // A scanner that looks straight down is tilted about image x, which stays level, then turned about the vertical.
  const double tilt = std::atan2(horizontal, -view.z());
  const double turn = horizontal > 0.0 ? std::atan2(-view.x(), view.y()) : 0.0;
  return {degrees(tilt), 0.0, degrees(turn)};
}

void describe(Fields& fields, Scanner& scanner) {
  fields.vector("position", scanner.position, {-1000.0, 1000.0}, "m",
                "of the optical centre; the origin is the centre of the bin's floor, z is up");
  fields.vector("rotation_deg", scanner.rotation_deg, {-360.0, 360.0}, "degrees",
                "about the world's x, y and z axes, in that order; zeros look straight down, image x along the bin");
  fields.integer("width", scanner.width, {1, 16384}, "pixels", "of the depth image");
  fields.integer("height", scanner.height, {1, 16384}, "pixels", "of the depth image");
  fields.number("horizontal_fov_deg", scanner.horizontal_fov_deg, {0.1, 170.0}, "degrees",
                "angle between the image's left and right border");
  fields.number("range_min", scanner.range_min, {0.0, 1000.0}, "m", "nearest depth along the optical axis");
  fields.number("range_max", scanner.range_max, {0.0, 1000.0}, "m", "farthest depth along the optical axis");
  fields.choice("region", scanner.region, {"bin", "full", "tubes"},
                "what becomes the cloud: the pixel window that covers the bin, all pixels, or tube points alone");
}

void check(const Scanner& scanner, const KeyPlaces& places, const std::string& prefix) {
  if (has_too_many_pixels(scanner))
    places.fail(prefix + ".width", fmt::format("{} x {} pixels are not valid; valid: up to {} pixels", scanner.width,
                                               scanner.height, kPixelsMax));
  if (scanner.range_max <= scanner.range_min)
    places.fail(prefix + ".range_max",
                fmt::format("{} m is not beyond range_min = {} m", scanner.range_max, scanner.range_min));
  check(scanner.effects, places, prefix + ".effects");
}

}  // namespace tubebin::scene
