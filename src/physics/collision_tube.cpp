#include "physics/collision.hpp"
#include "physics/mesh_collision.hpp"

namespace tubebin::physics {

SolidCylinder CollisionCylinder::solid(double eroded_by) const {
  const double from = flat_a ? eroded_by : 0.0;
  const double to = length - (flat_b ? eroded_by : 0.0);
  return {axis.a + from * direction, direction, std::max(to - from, 0.0), std::max(radius - eroded_by, 0.0)};
}

void CollisionCylinder::place(const Segment& to) {
  axis = to;
  direction = axis.b - axis.a;
  length = direction.norm();
  direction = length > 0.0 ? Vec3(direction / length) : Vec3::UnitZ();
  const Vec3 margin = Vec3::Constant(radius);
  bounds = scene::Box(axis.a.cwiseMin(axis.b) - margin, axis.a.cwiseMax(axis.b) + margin);
}

CollisionTube::CollisionTube(const scene::PlacedTube& tube) : solids_(tube::tube_solids(tube.tube, tube.tube.nodes)) {
  nodes.resize(tube.tube.nodes.size());
  radius = tube.tube.radius_max();
  const std::vector<int> degrees = tube.tube.node_degrees();
  for (const tube::JointSphere& joint : solids_.joints) {
    joints.push_back({joint.center, joint.radius});
    if (degrees[static_cast<std::size_t>(joint.node)] == 0)
      solids_.cylinders.push_back(
          {.node_a = joint.node, .node_b = joint.node, .a = joint.center, .b = joint.center, .radius = joint.radius});
  }
  for (const tube::SolidCylinder& cylinder : solids_.cylinders) {
    CollisionCylinder& posed = cylinders.emplace_back();
    posed.radius = cylinder.radius;
    posed.flat_a = cylinder.is_free_a;
    posed.flat_b = cylinder.is_free_b;
  }
  follow(tube);
}

void CollisionTube::follow(const scene::PlacedTube& tube) {
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = tube.world_from_tube * tube.tube.nodes[i];
  bounds.setEmpty();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Vec3 margin = Vec3::Constant(joints[i].radius);
    joints[i].center = nodes[static_cast<std::size_t>(solids_.joints[i].node)];
    bounds.extend(scene::Box(joints[i].center - margin, joints[i].center + margin));
  }
  for (std::size_t i = 0; i < cylinders.size(); ++i) {
    cylinders[i].place({nodes[static_cast<std::size_t>(solids_.cylinders[i].node_a)],
                        nodes[static_cast<std::size_t>(solids_.cylinders[i].node_b)]});
    bounds.extend(cylinders[i].bounds);
  }
}

std::vector<CollisionBox> collision_boxes(const scene::Bin& bin) {
  if (bin.has_mesh()) return {};
  constexpr double kGroundDepth = 1.0;  // metres; far beyond what a tube covers in a step
  std::vector<scene::BinPart> parts = scene::bin_parts(bin);
  const std::size_t standing = scene::inner_faces(bin).size();  // floor, walls and corners; then the rim
  for (std::size_t i = 0; i < standing; ++i) parts[i].box.min().z() -= kGroundDepth;
  if (bin.is_box())
    for (const std::size_t wall : {3u, 4u}) {  // at -y and +y, between the others
      parts[wall].box.min().x() -= bin.wall_thickness;
      parts[wall].box.max().x() += bin.wall_thickness;
    }
  return {parts.begin(), parts.end()};
}

std::vector<CollisionBox> guard_boxes(const scene::Bin& bin, double height) {
  std::vector<scene::BinPart> walls = scene::bin_parts({.length = bin.length,
                                                        .width = bin.width,
                                                        .height = std::max(height, bin.height),
                                                        .wall_thickness = bin.wall_thickness});
  walls.erase(walls.begin());  // the floor
  for (scene::BinPart& wall : walls) wall.box.min().z() = bin.height;
  return {walls.begin(), walls.end()};
}

std::vector<scene::Contact> find_contacts(const std::vector<scene::PlacedTube>& tubes, const scene::Bin& bin,
                                          double depth_min) {
  std::vector<CollisionTube> shapes;
  for (const scene::PlacedTube& tube : tubes) shapes.emplace_back(tube);
  const std::vector<CollisionBox> boxes = collision_boxes(bin);
  const scene::TriangleTree mesh(scene::mesh_triangles(bin));
  std::vector<scene::Contact> contacts;
  std::vector<Touch> touches;
  const auto append = [&](std::size_t label_a, std::size_t label_b) {
    for (const Touch& touch : touches)
      contacts.push_back({static_cast<std::uint32_t>(label_a), static_cast<std::uint32_t>(label_b), touch.position,
                          touch.normal, touch.depth});
    touches.clear();
  };
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    collide(boxes, shapes[i], depth_min, touches);
    collide(mesh, shapes[i], depth_min, touches);
    append(0, i + 1);
    for (std::size_t j = i + 1; j < shapes.size(); ++j) {
      collide(shapes[i], shapes[j], depth_min, touches);
      append(i + 1, j + 1);
    }
  }
  return contacts;
}

}  // namespace tubebin::physics
