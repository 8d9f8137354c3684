/// The solids that make up a tube: all that physics, scan, pictures, exports and relations know of its shape.
#pragma once

#include <vector>

#include "tubebin/tube/tube.hpp"

namespace tubebin::tube {

/// A cylinder with flat ends, metres. Where `is_free_*` no other cylinder meets it; elsewhere a joint's sphere rounds it.
struct SolidCylinder {
  int node_a = 0;  ///< index into Tube::nodes
  int node_b = 0;  ///< index into Tube::nodes
  Vec3 a;
  Vec3 b;
  double radius = 0.0;
  double bore_radius = 0.0;  ///< 0: no bore
  bool is_free_a = false;
  bool is_free_b = false;
};

/// The sphere at a node that two or more cylinders share, or at a node alone; metres.
struct JointSphere {
  int node = 0;  ///< index into Tube::nodes
  Vec3 center;
  double radius = 0.0;
  double bore_radius = 0.0;  ///< 0: no bore
};

/// A tube's body is the union of its solids (paper, Section 3) without the union of their bores, which have the same axes
/// and planes.
struct TubeSolids {
  std::vector<SolidCylinder> cylinders;  ///< in the order of Tube::cylinders
  std::vector<JointSphere> joints;       ///< by node

  /// Whether one can look into a bore.
  bool has_open_end() const;
};

/// In the frame of `nodes`, which are the tube's in any pose: its own, the world's or the scanner's.
TubeSolids tube_solids(const Tube& tube, const std::vector<Vec3>& nodes);

}  // namespace tubebin::tube
