#include <fmt/format.h>

#include <cmath>

#include "tubebin/scene/scene.hpp"

namespace tubebin::scene {
namespace {

/// A rounded corner is made of so many flat facets, which the arc touches: 0.9 % of its radius is the most they are off.
constexpr int kFacets = 5;
constexpr double kFacetAngle = radians(90.0) / (kFacets + 1);

/// What a wall or a corner's facet shows to the inside, a part of a plane that leans outward.
struct Side {
  Vec3 across;                ///< outward, horizontal, unit
  Vec3 at_floor;              ///< the middle of its lower edge
  Vec3 drift = Vec3::Zero();  ///< metres by which the middle moves for each metre up, horizontal
  double half_width = 0.0;    ///< metres, of the lower edge, without what the corners take
  double growth = 0.0;        ///< metres by which half_width grows for each metre up
  double turn = 0.0;          ///< angle to the next side, radians
  double corner_radius = 0.0;

  Vec3 along() const { return Vec3::UnitZ().cross(across); }
  double lean() const { return across.dot(drift); }
  Vec3 outward() const { return (across - lean() * Vec3::UnitZ()) / slope_length(); }
  double slope_length() const { return std::sqrt(1.0 + lean() * lean()); }
  /// Half of what a plate of a thickness takes to meet the next side's on the outside, too.
  double reach(double thickness) const { return half_width + (corner_radius + thickness) * std::tan(turn / 2.0); }
};

std::vector<Side> sides(const Bin& bin) {
  const double lean = std::tan(radians(bin.draft_deg)), radius = bin.corner_radius;
  const double x = bin.length / 2.0, y = bin.width / 2.0;
  const double turn = radius > 0.0 ? kFacetAngle : radians(90.0);
  std::vector<Side> sides;
  for (const Vec3& across : {Vec3(-Vec3::UnitX()), Vec3(Vec3::UnitX())})
    sides.push_back({across, x * across, lean * across, y - radius, lean, turn, radius});
  for (const Vec3& across : {Vec3(-Vec3::UnitY()), Vec3(Vec3::UnitY())})
    sides.push_back({across, y * across, lean * across, x - radius, lean, turn, radius});
  if (radius == 0.0) return sides;
  for (const double sign_x : {-1.0, 1.0})
    for (const double sign_y : {-1.0, 1.0})
      for (int i = 1; i <= kFacets; ++i) {
        const double c = std::cos(i * kFacetAngle), s = std::sin(i * kFacetAngle);
        const Vec3 across(sign_x * c, sign_y * s, 0.0), center(sign_x * (x - radius), sign_y * (y - radius), 0.0);
        sides.push_back({across, center + radius * across, lean * Vec3(sign_x, sign_y, 0.0), 0.0, 0.0, turn, radius});
      }
  return sides;
}

/// The floor and four walls of a box.
std::vector<BinPart> box_parts(const Bin& bin) {
  const double x = bin.length / 2.0;
  const double y = bin.width / 2.0;
  const double wall = bin.wall_thickness;
  return {{Box(Vec3(-x - wall, -y - wall, -wall), Vec3(x + wall, y + wall, 0.0))},
          {Box(Vec3(-x - wall, -y - wall, 0.0), Vec3(-x, y + wall, bin.height))},
          {Box(Vec3(x, -y - wall, 0.0), Vec3(x + wall, y + wall, bin.height))},
          {Box(Vec3(-x, -y - wall, 0.0), Vec3(x, -y, bin.height))},
          {Box(Vec3(-x, y, 0.0), Vec3(x, y + wall, bin.height))}};
}

/// A frame with x as given and y along the side.
BinPart part_at(const Vec3& origin, const Vec3& x_axis, const Side& side, const Box& box) {
  BinPart part{.box = box, .is_turned = true};
  part.world_from_part.linear() << x_axis, side.along(), x_axis.cross(side.along());
  part.world_from_part.translation() = origin;
  return part;
}

BinPart plate(const Side& side, const Bin& bin) {
  const double sideways = std::abs(side.drift.dot(side.along()));
  const double half = side.reach(bin.wall_thickness) + (side.growth + sideways) * bin.height;
  return part_at(side.at_floor, side.outward(), side,
                 Box(Vec3(0.0, -half, 0.0), Vec3(bin.wall_thickness, half, bin.height * side.slope_length())));
}

/// As thick as the walls, and level with their inner upper edges.
BinPart rim(const Side& side, const Bin& bin) {
  const double half = side.reach(bin.rim_width) + side.growth * bin.height;
  const Vec3 edge = side.at_floor + bin.height * (side.drift + Vec3::UnitZ());
  return part_at(edge, side.across, side, Box(Vec3(0.0, -half, -bin.wall_thickness), Vec3(bin.rim_width, half, 0.0)));
}

}  // namespace

std::array<Vec3, 8> BinPart::corners_in_world() const {
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = box.corner(static_cast<Box::CornerType>(i));
    if (is_turned) corners[i] = world_from_part * corners[i];
  }
  return corners;
}

Box BinPart::bounds_in_world() const {
  Box bounds;
  for (const Vec3& corner : corners_in_world()) bounds.extend(corner);
  return bounds;
}

std::vector<BinPart> bin_parts(const Bin& bin) {
  std::vector<BinPart> parts = box_parts(bin);
  if (bin.is_box()) return parts;
  parts.resize(1);  // the floor
  for (const Side& side : sides(bin)) parts.push_back(plate(side, bin));
  if (bin.rim_width > 0.0)
    for (const Side& side : sides(bin)) parts.push_back(rim(side, bin));
  return parts;
}

std::vector<InnerFace> inner_faces(const Bin& bin) {
  std::vector<InnerFace> faces = {{-Vec3::UnitZ(), 0.0}};
  for (const Side& side : sides(bin)) {
    const Vec3 outward = side.outward();
    faces.push_back({outward, outward.dot(side.at_floor)});
  }
  return faces;
}

void describe_box(Fields& fields, Bin& bin) {
  fields.number("length", bin.length, {0.001, 100.0}, "m", "inner size along x, at the floor");
  fields.number("width", bin.width, {0.001, 100.0}, "m", "inner size along y, at the floor");
  fields.number("height", bin.height, {0.001, 100.0}, "m", "height of the walls above the floor");
  fields.number("wall_thickness", bin.wall_thickness, {0.0001, 10.0}, "m", "of the walls, the floor and the rim");
}

void describe_walls(Fields& fields, Bin& bin) {
  fields.number("draft_deg", bin.draft_deg, {0.0, 45.0}, "degrees", "by which the walls lean outward");
  fields.number("rim_width", bin.rim_width, {0.0, 1.0}, "m",
                "of a flat rim around the walls' upper edge, from their inner faces outward; 0 is none");
  fields.number("corner_radius", bin.corner_radius, {0.0, 50.0}, "m",
                "of the upright corners' inner faces, each made of five flat facets; 0 is an edge");
}

void describe(Fields& fields, Bin& bin) {
  describe_box(fields, bin);
  describe_walls(fields, bin);
}

void check(const Bin& bin, const KeyPlaces& places, const std::string& prefix) {
  const double most = std::min(bin.length, bin.width) / 2.0;
  if (bin.corner_radius > most)
    places.fail(
        prefix + ".corner_radius",
        fmt::format("{} m is not valid; valid: up to {} m, half of the bin's shorter side", bin.corner_radius, most));
}

}  // namespace tubebin::scene
