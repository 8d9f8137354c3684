/// A rigid tube: a graph whose edges are cylinders and whose nodes are the points where they meet or end.
/// Chains are the paper's tubes (Section 3); trees are branching tubes; a loop is a ring; a node alone is a sphere.
#pragma once

#include <string>
#include <vector>

#include "tubebin/core/distribution.hpp"

namespace tubebin::tube {

/// A cylinder between two nodes, with flat ends. At a node that two or more cylinders share, a sphere of the thickest one's
/// radius fills the joint (paper, Section 3).
struct Cylinder {
  int node_a = 0;       ///< index into Tube::nodes
  int node_b = 0;       ///< index into Tube::nodes
  int order = 0;        ///< position of the cylinder along its path, from 0
  double radius = 0.0;  ///< outer, metres; 0: the tube's

  friend bool operator==(const Cylinder&, const Cylinder&) = default;
};

struct Tube {
  double radius = 0.0;          ///< outer radius of all cylinders that have none of their own, metres
  double wall_thickness = 0.0;  ///< metres; 0: solid
  double mass = 0.0;            ///< kilograms
  std::vector<Vec3> nodes;      ///< metres, in the tube's own frame
  std::vector<Cylinder> cylinders;
  std::string kind = {};    ///< its kind's name in a mixed bin; empty where all tubes are of one kind
  DrawnNumbers drawn = {};  ///< of its options, those that were drawn for it alone

  double radius_of(const Cylinder& cylinder) const { return cylinder.radius > 0.0 ? cylinder.radius : radius; }
  /// Of the joint's sphere at each node: that of the thickest cylinder there; the tube's at a node alone.
  std::vector<double> node_radii() const;
  /// Of the thickest part, metres.
  double radius_max() const;

  /// Number of cylinders that meet at each node.
  std::vector<int> node_degrees() const;
  /// Unit directions of the cylinders that leave a node; `except` is the index of one to leave out.
  std::vector<Vec3> directions_from(int node, std::size_t except = static_cast<std::size_t>(-1)) const;
  /// Length of one cylinder, metres.
  double length(const Cylinder& cylinder) const {
    return (nodes[static_cast<std::size_t>(cylinder.node_b)] - nodes[static_cast<std::size_t>(cylinder.node_a)]).norm();
  }
  /// Sum of the cylinders' lengths, metres.
  double length() const;
};

/// The body's mass (kg), centre of mass (m, tube frame) and inertia about that centre (kg m^2, tube axes).
struct MassProperties {
  double mass = 0.0;
  Vec3 center = Vec3::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

/// Of the union of the tube's cylinders and joint spheres, solid or with a bore, at uniform density.
MassProperties mass_properties(const Tube& tube);

}  // namespace tubebin::tube
