#include "scan/scene_solids.hpp"

namespace tubebin::scan {
namespace {

void add_tube(const scene::PlacedTube& placed, cloud::Label label, const Vec3& scanner_in_world, SceneSolids& solids) {
  const tube::Tube& tube = placed.tube;
  const auto bore_radius = [&](double radius) {
    return tube.wall_thickness > 0.0 ? radius - tube.wall_thickness : 0.0;
  };
  const auto node_seen = [&](int node) -> Vec3 { return placed.node_in_world(node) - scanner_in_world; };
  for (const tube::Cylinder& cylinder : tube.cylinders) {
    const Vec3 base = node_seen(cylinder.node_a);
    const Vec3 top = node_seen(cylinder.node_b);
    const double radius = tube.radius_of(cylinder);
    if (base != top) solids.cylinders.push_back({SolidCylinder(base, top, radius), label, bore_radius(radius)});
  }
  const std::vector<int> degrees = tube.node_degrees();
  const std::vector<double> radii = tube.node_radii();
  for (int node = 0; node < static_cast<int>(degrees.size()); ++node)
    if (const auto i = static_cast<std::size_t>(node); degrees[i] != 1)
      solids.spheres.push_back({SolidSphere(node_seen(node), radii[i]), label, bore_radius(radii[i])});
}

}  // namespace

SceneSolids scene_solids(const scene::Scene& scene) {
  SceneSolids solids;
  cloud::Label label = 0;
  for (const scene::PlacedTube& tube : scene.tubes) add_tube(tube, ++label, scene.scanner.position, solids);
  solids.bin = scene::bin_boxes(scene.bin);
  for (scene::Box& box : solids.bin) box.translate(-scene.scanner.position);
  return solids;
}

}  // namespace tubebin::scan
