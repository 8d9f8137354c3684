/// Contacts between tubes, and between tubes and the bin, of the very surfaces that the scanner sees.
///
/// A tube is the union of convex solids, one for each of its cylinders: the points within the radius of the axis, cut flat
/// at free ends. That is exactly cylinders plus joint spheres; a lone sphere is a cylinder of no length. Only where two flat
/// ends meet each other, or a flat end's face a bin edge, their rims are rounded by kRimRounding.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "physics/convex.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::physics {

/// The sharp rim lies (sqrt(2) - 1) * 1 mm = 0.41 mm off the rounded one.
constexpr double kRimRounding = 0.001;

/// One cylinder of a tube, posed in the world.
struct CollisionCylinder {
  Segment axis;
  Vec3 direction;  ///< unit, a to b
  double length = 0.0;
  double radius = 0.0;
  bool flat_a = false;  ///< a free end: cut flat
  bool flat_b = false;
  scene::Box bounds;

  /// To where its axis is.
  void place(const Segment& to);
  SolidCylinder solid(double eroded_by = 0.0) const;
};

struct Ball {
  Vec3 center;
  double radius = 0.0;
};

/// A tube posed in the world.
struct CollisionTube {
  explicit CollisionTube(const scene::PlacedTube& tube);
  /// To where the same tube is now, without allocation.
  void follow(const scene::PlacedTube& tube);

  std::vector<Vec3> nodes;
  std::vector<CollisionCylinder> cylinders;
  std::vector<Ball> joints;  ///< at nodes shared by two cylinders or more, and lone spheres, which are cylinders, too
  double radius = 0.0;       ///< of the thickest part
  scene::Box bounds;

 private:
  tube::TubeSolids solids_;  ///< in the tube's frame
};

/// Where two bodies touch or nearly do.
struct Touch {
  Vec3 position;
  Vec3 normal;         ///< unit, from the first body into the second
  double depth = 0.0;  ///< metres of interpenetration; negative: a gap
};

/// A solid box of the bin.
struct CollisionBox {
  explicit CollisionBox(const scene::BinPart& of) : part(of), bounds(of.bounds_in_world()) {}

  scene::BinPart part;
  scene::Box bounds;  ///< world frame
};

/// The bin as it collides: bin_parts() with the ground below the floor, so that nothing falls through. Walls reach down into
/// it and overlap at the corners, so that the shortest way out of one never leads into another.
std::vector<CollisionBox> collision_boxes(const scene::Bin& bin);

/// Points around a flat end's rim, `center` its middle: the one that lies farthest along `toward` and seven more around,
/// which keep a standing tube upright.
std::array<Vec3, 8> rim_points(const CollisionCylinder& cylinder, const Vec3& center, const Vec3& toward);

/// Of touches from `begin` on, neighbours find the same one twice, as cylinders at the joint between them: the deepest of a
/// spot (metres) stays.
void keep_deepest_of_each_spot(std::size_t begin, double spot, std::vector<Touch>& touches);

/// Smooth walls that nobody sees, on a bin's inner space from its height up to another (metres).
std::vector<CollisionBox> guard_boxes(const scene::Bin& bin, double height);

/// Indices of a cylinder of one tube and of a cylinder of another.
struct CylinderPair {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
};

/// Appends the pairs of cylinders that come within `reach` (metres).
void find_near_cylinders(const CollisionTube& first, const CollisionTube& second, double reach,
                         std::vector<CylinderPair>& out);

/// Appends the touches of two tubes with depth >= `depth_min` (metres; negative to find gaps too).
void collide(const CollisionTube& first, const CollisionTube& second, double depth_min, std::vector<Touch>& out);
/// As above, looking at these pairs of cylinders alone.
void collide(const CollisionTube& first, const CollisionTube& second, const std::vector<CylinderPair>& pairs,
             double depth_min, std::vector<Touch>& out);

/// Appends the touches of the bin (first) and a tube (second) with depth >= `depth_min`.
void collide(const std::vector<CollisionBox>& bin, const CollisionTube& tube, double depth_min,
             std::vector<Touch>& out);

/// All touches of a scene, labelled. `depth_min` as above.
std::vector<scene::Contact> find_contacts(const std::vector<scene::PlacedTube>& tubes, const scene::Bin& bin,
                                          double depth_min);

}  // namespace tubebin::physics
