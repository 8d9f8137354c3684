#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <tuple>

#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/path_status.hpp"
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

bool operator==(const Bin& a, const Bin& b) {
  const auto values = [](const Bin& bin) {
    return std::tie(bin.length, bin.width, bin.height, bin.wall_thickness, bin.draft_deg, bin.rim_width,
                    bin.corner_radius, bin.mesh, bin.mesh_scale);
  };
  return values(a) == values(b);
}

std::vector<BinPart> bin_parts(const Bin& bin) {
  if (bin.has_mesh()) return {};
  std::vector<BinPart> parts = box_parts(bin);
  if (bin.is_box()) return parts;
  parts.resize(1);  // the floor
  for (const Side& side : sides(bin)) parts.push_back(plate(side, bin));
  if (bin.rim_width > 0.0)
    for (const Side& side : sides(bin)) parts.push_back(rim(side, bin));
  return parts;
}

Box bin_bounds(const Bin& bin) {
  if (bin.surface) return bin.surface->bounds;
  Box bounds;
  for (const BinPart& part : bin_parts(bin)) bounds.extend(part.bounds_in_world());
  return bounds;
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

void describe_mesh(Fields& fields, Bin& bin) {
  fields.text(
      "mesh", bin.mesh,
      "STL file, relative to this one, of the bin's surfaces in its frame (origin at the middle of the floor, z "
      "up), instead of walls, rim and corners; length, width and height are then the space within it that tubes "
      "fall into");
  fields.number("mesh_scale", bin.mesh_scale, {1e-6, 1000.0}, "m",
                "for each unit of the mesh's file; 0.001 for millimetres");
}

namespace {

void check_mesh(const Bin& bin, const KeyPlaces& places, const std::string& prefix) {
  if (!bin.is_box())
    places.fail(prefix + ".mesh", fmt::format("'{}' is not valid beside draft_deg, rim_width or corner_radius; valid: "
                                              "one or the other, a mesh has walls of its own",
                                              bin.surface->path));
  const Box inner(Vec3(-bin.length / 2.0, -bin.width / 2.0, 0.0), Vec3(bin.length / 2.0, bin.width / 2.0, bin.height));
  const Box bounds = bin_bounds(bin);
  const Vec3 rounding = Vec3::Constant(1e-6);  // metres; STL's numbers are single
  const char* keys[] = {".length", ".width", ".height"};
  for (int axis = 0; axis < 3; ++axis)
    if (inner.min()[axis] < bounds.min()[axis] - rounding[axis] ||
        inner.max()[axis] > bounds.max()[axis] + rounding[axis])
      places.fail(
          prefix + keys[axis],
          fmt::format("{} m is not valid; valid: a space within the mesh of {}, which reaches from {:.6g} to {:.6g} m "
                      "along {} (mesh_scale {}; the middle of the floor is the origin)",
                      inner.sizes()[axis], bin.surface->path, bounds.min()[axis], bounds.max()[axis], "xyz"[axis],
                      bin.mesh_scale));
}

}  // namespace

const std::vector<Triangle>& mesh_triangles(const Bin& bin) {
  static const std::vector<Triangle> none;
  if (!bin.has_mesh()) return none;
  if (!bin.surface)
    throw_io_error("{}: the bin's mesh is not there; valid: that file in the data set's folder", bin.mesh);
  return bin.surface->triangles;
}

void load_mesh(Bin& bin, const std::string& folder) {
  if (!bin.has_mesh()) return;
  if (is_regular_file(folder))
    throw_io_error("{}: a pack does not hold the mesh of its bin, {}; valid: the data set's folder, which does", folder,
                   bin.mesh);
  const std::string path = (std::filesystem::path(folder) / bin.mesh).string();
  constexpr std::uint64_t kBytesMax = 100'000'000;  // ten times what a binary file may need: ASCII is longer
  bin.surface = std::make_shared<const BinMesh>(parse_stl(read_file(path, kBytesMax), path, bin.mesh_scale));
  const std::string name = bin.surface->file_name();
  if (bin.mesh.starts_with("bin-") && bin.mesh.size() == name.size() && bin.mesh != name)
    throw_io_error(
        "{}: its content has changed: it would be called {}; valid: the file that the data set was made with", path,
        name);
  bin.mesh = name;
}

void load_mesh(Bin& bin, const KeyPlaces& places, const std::string& prefix) {
  std::string file = places.find(prefix + ".mesh");
  for (int number = 0; number < 2; ++number) file.resize(std::min(file.rfind(':'), file.size()));  // line and column
  load_mesh(bin, std::filesystem::path(file).parent_path().string());
}

void check(const Bin& bin, const KeyPlaces& places, const std::string& prefix) {
  if (bin.has_mesh()) return check_mesh(bin, places, prefix);
  const double most = std::min(bin.length, bin.width) / 2.0;
  if (bin.corner_radius > most)
    places.fail(
        prefix + ".corner_radius",
        fmt::format("{} m is not valid; valid: up to {} m, half of the bin's shorter side", bin.corner_radius, most));
}

}  // namespace tubebin::scene
