// The convex solids whose union is the scene, as the scanner sees them: world axes, origin at the scanner.
#pragma once

#include <vector>

#include "scan/exact_shapes.hpp"
#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin {

template <typename Solid>
struct Labelled {
  Solid solid;
  Label label = 0;
};

struct SceneSolids {
  std::vector<Labelled<SolidCylinder>> cylinders;
  std::vector<Labelled<SolidSphere>> spheres;  ///< where two or more cylinders meet, and nodes alone
  std::vector<Box> bin;
};

SceneSolids scene_solids(const Scene& scene);

}  // namespace tubebin
