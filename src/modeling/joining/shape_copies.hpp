/// Where copies of a known shape may lie.
#pragma once

#include <span>
#include <vector>

#include "modeling/joining/occlusion.hpp"

namespace tubebin::modeling {

/// Part of a piece between two sharp bends: pieces may go over from one tube to another where they touch, by a bend that no
/// tube has there.
struct Section {
  std::vector<Vec3> samples;  ///< of its centreline, every half radius
  double length = 0.0;        ///< metres
  double evidence = 0.0;      ///< nats, as TubePiece has it
};

/// A section on a copy of the shape.
struct PlacedSection {
  std::uint32_t section = 0;
  std::size_t first = 0, last = 0;  ///< samples of the shape that it lies on
  bool is_reversed = false;         ///< it leads from the last to the first
  double distance = 0.0;            ///< root mean square from the copy, metres
};

struct ShapeCopy {
  const std::vector<Vec3>* shape;     ///< that it is a copy of, by samples every half radius
  Pose pose;                          ///< that the copy lies in, in the cloud's frame
  std::vector<PlacedSection> placed;  ///< in the shape's order
  double cost = 0.0;                  ///< nats: -log of how much likelier the scan is with it than without
};

/// A copy that costs more is ruled out.
constexpr double kCopyCostLimit = 9.0;

/// All copies of each of `shapes`, centrelines by samples every half radius, that explain sections enough to know where they
/// lie, the best for each set of sections. None at all as soon as long sections alone leave less than `least_explained` (0 to 1)
/// of what is seen to copies. Keeps references to the shapes.
std::vector<std::vector<ShapeCopy>> find_shape_copies(std::span<const Section> sections,
                                                      std::span<const std::vector<Vec3>> shapes, double radius,
                                                      const OcclusionTest& occlusion, double least_explained);

/// Whether the curve lies on the copy from one end to the other, as far as fits tell.
bool lies_on_copy(const Section& section, const ShapeCopy& copy, double radius);

}  // namespace tubebin::modeling
