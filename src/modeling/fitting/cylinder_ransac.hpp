/// RANSAC (Fischler and Bolles 1981) for a cylinder.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::modeling {

/// A cylinder's axis, without ends. Metres.
struct AxisLine {
  Vec3 point, direction;
};

struct CylinderSearch {
  double radius = 0.0;           ///< metres; a cylinder's may be a fifth off
  double inlier_distance = 0.0;  ///< metres; a radian between a point's normal and the cylinder's counts as 0.05 more
  int iterations = 0;            ///< at most; fewer where a sample without outliers was likely among them
};

/// The axis of the cylinder with most inliers, of those through two of the points along their normals; none with fewer
/// than five inliers. As PCL's SACSegmentationFromNormals finds it, with the same numbers drawn.
std::optional<AxisLine> search_cylinder(std::span<const cloud::Point> points, std::span<const cloud::Point> normals,
                                        const CylinderSearch& search);

}  // namespace tubebin::modeling
