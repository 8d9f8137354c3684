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

SolidBox box_around_scanner(const scene::BinPart& part, const Vec3& scanner_in_world) {
  const Eigen::Matrix3d axes = part.world_from_part.linear();
  scene::Box box = part.box;
  box.translate(axes.transpose() * Vec3(part.world_from_part.translation() - scanner_in_world));
  return {box, axes, part.is_turned};
}

}  // namespace

SceneSolids scene_solids(const scene::Scene& scene) {
  SceneSolids solids;
  const Vec3& scanner = scene.scanner.position;
  cloud::Label label = 0;
  for (const scene::PlacedTube& tube : scene.tubes) add_tube(tube, ++label, scanner, solids);
  for (const scene::BinPart& part : scene::bin_parts(scene.bin))
    solids.bin.push_back(box_around_scanner(part, scanner));
  solids.bin_mesh = scene::mesh_triangles(scene.bin);
  for (scene::Triangle& triangle : solids.bin_mesh)
    for (Vec3& corner : triangle.corners) corner -= scanner;
  for (const scene::BinPart& part : scene::surrounding_boxes(scene))
    solids.boxes_around.push_back({box_around_scanner(part, scanner), 0});
  for (const scene::StandingCylinder& cylinder : scene::surrounding_cylinders(scene)) {
    const Vec3 base = cylinder.position - scanner;
    solids.cylinders_around.push_back(
        {SolidCylinder(base, base + cylinder.height * Vec3::UnitZ(), cylinder.radius), 0});
  }
  return solids;
}

}  // namespace tubebin::scan
