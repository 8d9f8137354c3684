#include "scan/scene_solids.hpp"

namespace tubebin::scan {
namespace {

void add_tube(const scene::PlacedTube& placed, cloud::Label label, const Vec3& scanner_in_world, SceneSolids& solids) {
  const tube::TubeSolids tube = placed.solids_in_world();
  for (const tube::SolidCylinder& cylinder : tube.cylinders) {
    const Vec3 base = cylinder.a - scanner_in_world, top = cylinder.b - scanner_in_world;
    if (base != top)
      solids.cylinders.push_back({SolidCylinder(base, top, cylinder.radius), label, cylinder.bore_radius});
  }
  for (const tube::JointSphere& joint : tube.joints)
    solids.spheres.push_back({SolidSphere(joint.center - scanner_in_world, joint.radius), label, joint.bore_radius});
}

}  // namespace

SceneSolids scene_solids(const scene::Scene& scene) {
  SceneSolids solids;
  cloud::Label label = 0;
  for (const scene::PlacedTube& tube : scene.tubes) add_tube(tube, ++label, scene.scanner.position, solids);
  for (const scene::BinPart& part : scene::bin_parts(scene.bin)) {
    const Eigen::Matrix3d axes = part.world_from_part.linear();
    scene::Box box = part.box;
    box.translate(axes.transpose() * Vec3(part.world_from_part.translation() - scene.scanner.position));
    solids.bin.emplace_back(box, axes, part.is_turned);
  }
  return solids;
}

}  // namespace tubebin::scan
