// Outward normals of a scene's surfaces.
#pragma once

#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin {

class SurfaceNormals {
 public:
  explicit SurfaceNormals(const Scene& scene);

  /// Unit normal of the labelled body's part of the surface that is nearest to the point (world frame, metres).
  Vec3 at(Label label, const Vec3& point) const;

 private:
  struct TubeParts {
    double radius = 0.0;
    double bore_radius = 0.0;                      // 0: solid
    std::vector<std::pair<Vec3, Vec3>> axes;       // of the cylinders
    std::vector<std::pair<Vec3, Vec3>> free_ends;  // centre and outward unit normal
    std::vector<Vec3> joints;
  };
  Vec3 at_tube(const TubeParts& tube, const Vec3& point) const;
  Vec3 at_bin(const Vec3& point) const;

  Bin bin_;
  std::vector<TubeParts> tubes_;
};

}  // namespace tubebin
