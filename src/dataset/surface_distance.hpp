/// How far a point is from the surface that its label names. Kept apart from the scanner's own formulas, which it
/// checks.
#pragma once

#include <vector>

#include "tubebin/scene/scene.hpp"
#include "tubebin/scene/triangle_tree.hpp"

namespace tubebin::dataset {

/// The surfaces of one body: a tube's cylinders and joint spheres, outside and in its bore; or what has label 0, the bin's
/// parts and those of what stands around it.
class BodySurface {
 public:
  explicit BodySurface(const scene::PlacedTube& tube);
  explicit BodySurface(const scene::Scene& scene);

  /// Metres to the nearest of the body's surfaces, from whichever side.
  double distance(const Vec3& point) const;

 private:
  struct CappedCylinder {
    Vec3 center;
    Vec3 axis;  ///< unit
    double half_length = 0.0;
    double radius = 0.0;
    double bore_radius = 0.0;  ///< 0: solid
  };
  struct Sphere {
    Vec3 center;
    double radius = 0.0;
    double bore_radius = 0.0;
  };
  std::vector<CappedCylinder> cylinders_;
  std::vector<Sphere> spheres_;
  struct PosedBox {
    scene::Box box;
    Pose box_from_world;
  };
  std::vector<PosedBox> boxes_;
  scene::TriangleTree mesh_;
};

/// By label.
std::vector<BodySurface> surfaces_of(const scene::Scene& scene);

}  // namespace tubebin::dataset
