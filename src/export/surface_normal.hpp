// Outward normals of a scene's surfaces.
#pragma once

#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::exports {

class SurfaceNormals {
 public:
  explicit SurfaceNormals(const scene::Scene& scene);

  /// Unit normal of the labelled body's part of the surface that is nearest to the point (world frame, metres).
  Vec3 at(cloud::Label label, const Vec3& point) const;

 private:
  struct TubeParts {
    struct Axis {
      Vec3 a, b;
      double radius;
    };
    struct FreeEnd {
      Vec3 center, normal;  // outward, unit
      double radius;
    };
    struct Joint {
      Vec3 center;
      double radius;
    };
    double wall_thickness = 0.0;  // 0: solid
    std::vector<Axis> axes;       // of the cylinders
    std::vector<FreeEnd> free_ends;
    std::vector<Joint> joints;
  };
  Vec3 at_tube(const TubeParts& tube, const Vec3& point) const;
  Vec3 at_bin(const Vec3& point) const;

  scene::Bin bin_;
  std::vector<TubeParts> tubes_;
};

}  // namespace tubebin::exports
