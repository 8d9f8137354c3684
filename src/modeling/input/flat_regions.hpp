/// What stands around the tubes and is flat: floor, table, walls, rims, boxes, of any pose.
#pragma once

#include <cmath>
#include <vector>

#include "modeling/input/flat_blocks.hpp"

namespace tubebin::modeling {

/// A plane: points p on it have normal . p = offset (metres).
struct Plane {
  Vec3 normal = Vec3::UnitZ();  ///< unit
  double offset = 0.0;

  double height(const Vec3& p) const { return normal.dot(p) - offset; }
};

/// A part of the scan that lies on one plane and is flat over more than a tube of up to 40 spacings' radius could be.
struct FlatRegion {
  Plane plane;  ///< its normal toward the viewpoint
  Vec3 center = Vec3::Zero();
  Vec3 axes[2] = {Vec3::UnitX(), Vec3::UnitY()};  ///< unit, in the plane, along the longer and the shorter side
  double half_extents[2] = {};                    ///< metres, of the rectangle about it, along the axes
  double noise = 0.0;                             ///< metres, standard deviation of its points' distances to the plane
  double area = 0.0;                              ///< square metres, of the rectangle
  double tolerance = 0.0;  ///< metres, how far from the plane its points may lie: four standard deviations, and some
  bool is_solid = false;   ///< nothing was measured behind it, nearer than its distance to the points before it

  /// Whether the point lies on the plane as far as noise lets one tell.
  bool lies_on_plane(const Vec3& point) const { return std::abs(plane.height(point)) < tolerance; }
  /// The same, and not farther than `margin` (metres) outside the
  /// rectangle.
  bool holds(const Vec3& point, double margin) const;
  /// Whether the point lies before or behind the rectangle, widened by the margin.
  bool spans(const Vec3& point, double margin) const;
};

/// Flat regions of the view, largest first. `blocks`: of the view; wider ones are taken where noise tilts these.
std::vector<FlatRegion> find_flat_regions(FlatBlocks blocks, const SourceView& view);

}  // namespace tubebin::modeling
