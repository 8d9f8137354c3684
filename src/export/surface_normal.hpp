// Outward normals of a scene's surfaces.
#pragma once

#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/scene.hpp"
#include "tubebin/scene/triangle_tree.hpp"

namespace tubebin::exports {

class SurfaceNormals {
 public:
  explicit SurfaceNormals(const scene::Scene& scene);

  /// Unit normal of the labelled body's part of the surface that is nearest to the point (world frame, metres).
  Vec3 at(cloud::Label label, const Vec3& point) const;

 private:
  Vec3 at_tube(const tube::TubeSolids& tube, const Vec3& point) const;
  Vec3 at_background(const Vec3& point) const;

  std::vector<scene::BinPart> boxes_;  ///< of the bin and of what stands around it
  std::vector<scene::StandingCylinder> cylinders_;
  std::vector<tube::TubeSolids> tubes_;
  scene::TriangleTree mesh_;  ///< of the bin
  Vec3 scanner_;
};

}  // namespace tubebin::exports
