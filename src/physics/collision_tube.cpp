#include "physics/collision.hpp"

namespace tubebin::physics {

SolidCylinder Piece::solid(double eroded_by) const {
  const double from = flat_a ? eroded_by : 0.0;
  const double to = length - (flat_b ? eroded_by : 0.0);
  return {axis.a + from * direction, direction, std::max(to - from, 0.0), std::max(radius - eroded_by, 0.0)};
}

namespace {

/// What does not depend on the pose, and room for what does.
void begin_parts(const tube::Tube& tube, const std::vector<int>& node_degrees, CollisionTube& out) {
  const std::vector<double> radii = tube.node_radii();
  out.radius = tube.radius_max();
  out.nodes.resize(tube.nodes.size());
  out.pieces.resize(tube.cylinders.size());
  for (std::size_t i = 0; i < tube.nodes.size(); ++i)
    if (node_degrees[i] != 1) out.joints.push_back({tube.nodes[i], radii[i]});
}

}  // namespace

void update_collision_tube(const scene::PlacedTube& tube, const std::vector<int>& node_degrees, CollisionTube& out) {
  if (out.radius == 0.0) begin_parts(tube.tube, node_degrees, out);
  out.bounds.setEmpty();
  auto joint = out.joints.begin();
  for (std::size_t i = 0; i < out.nodes.size(); ++i) {
    out.nodes[i] = tube.world_from_tube * tube.tube.nodes[i];
    if (node_degrees[i] == 1) continue;
    const Vec3 margin = Vec3::Constant(joint->radius);
    joint->center = out.nodes[i];
    out.bounds.extend(scene::Box(joint->center - margin, joint->center + margin));
    ++joint;
  }
  for (std::size_t i = 0; i < out.pieces.size(); ++i) {
    const tube::Cylinder& cylinder = tube.tube.cylinders[i];
    Piece& piece = out.pieces[i];
    const auto a = static_cast<std::size_t>(cylinder.node_a), b = static_cast<std::size_t>(cylinder.node_b);
    piece.axis = {out.nodes[a], out.nodes[b]};
    piece.direction = piece.axis.b - piece.axis.a;
    piece.length = piece.direction.norm();
    piece.direction /= piece.length;
    piece.radius = tube.tube.radius_of(cylinder);
    const Vec3 margin = Vec3::Constant(piece.radius);
    piece.flat_a = node_degrees[a] == 1;
    piece.flat_b = node_degrees[b] == 1;
    piece.bounds =
        scene::Box(piece.axis.a.cwiseMin(piece.axis.b) - margin, piece.axis.a.cwiseMax(piece.axis.b) + margin);
    out.bounds.extend(piece.bounds);
  }
}

CollisionTube collision_tube(const scene::PlacedTube& tube) {
  CollisionTube out;
  update_collision_tube(tube, tube.tube.node_degrees(), out);
  return out;
}

std::vector<scene::Box> collision_boxes(const scene::Bin& bin) {
  constexpr double kGroundDepth = 1.0;  // metres; far beyond what a tube covers in a step
  std::vector<scene::Box> boxes = scene::bin_boxes(bin);
  for (scene::Box& box : boxes) box.min().z() -= kGroundDepth;
  for (const std::size_t wall : {3u, 4u}) {  // at -y and +y, between the others
    boxes[wall].min().x() -= bin.wall_thickness;
    boxes[wall].max().x() += bin.wall_thickness;
  }
  return boxes;
}

std::vector<scene::Contact> find_contacts(const std::vector<scene::PlacedTube>& tubes, const scene::Bin& bin,
                                          double depth_min) {
  std::vector<CollisionTube> shapes;
  for (const scene::PlacedTube& tube : tubes) shapes.push_back(collision_tube(tube));
  const std::vector<scene::Box> boxes = collision_boxes(bin);
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
    append(0, i + 1);
    for (std::size_t j = i + 1; j < shapes.size(); ++j) {
      collide(shapes[i], shapes[j], depth_min, touches);
      append(i + 1, j + 1);
    }
  }
  return contacts;
}

}  // namespace tubebin::physics
