// First surfaces of a triangle mesh along rays from the origin: Embree finds the triangles near a ray, double precision
// decides.
#pragma once

#include <vector>

#include "scan/embree.hpp"
#include "tubebin/scene/bin_mesh.hpp"

namespace tubebin::scan {

class MeshCaster {
 public:
  /// `triangles` in the axes of the rays, the scanner at the origin.
  explicit MeshCaster(std::vector<scene::Triangle> triangles);
  MeshCaster(const MeshCaster&) = delete;  // Embree holds pointers to the triangles
  MeshCaster& operator=(const MeshCaster&) = delete;

  const std::vector<scene::Triangle>& triangles() const { return triangles_; }
  /// The least t in [depth_min, depth_max] with t * direction on a triangle; infinity where there is none. No ray passes
  /// between two triangles that share an edge.
  double first_depth(const Vec3& direction, double depth_min, double depth_max) const;

 private:
  std::vector<scene::Triangle> triangles_;
  embree::Scene scene_;
};

}  // namespace tubebin::scan
