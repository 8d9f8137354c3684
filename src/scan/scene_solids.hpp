// The convex solids and triangles whose union is the scene, as the scanner sees them: world axes, origin at the scanner.
#pragma once

#include <vector>

#include "scan/exact_shapes.hpp"
#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::scan {

template <typename Solid>
struct Labelled {
  Solid solid;
  cloud::Label label = 0;
  double bore_radius = 0.0;  ///< metres; 0: the solid has no bore
};

/// Tubes by tube::TubeSolids, the bin by scene::bin_parts or its mesh, and what stands around it, which has its label, too.
struct SceneSolids {
  std::vector<Labelled<SolidCylinder>> cylinders;
  std::vector<Labelled<SolidSphere>> spheres;  ///< where two or more cylinders meet, and nodes alone
  std::vector<SolidBox> bin;
  std::vector<scene::Triangle> bin_mesh = {};  ///< where the bin has a mesh
  std::vector<Labelled<SolidBox>> boxes_around = {};
  std::vector<Labelled<SolidCylinder>> cylinders_around = {};
};

SceneSolids scene_solids(const scene::Scene& scene);

}  // namespace tubebin::scan
