#include "render/mesh.hpp"

#include <algorithm>
#include <cmath>

namespace tubebin::render {
namespace {

class MeshBuilder {
 public:
  MeshBuilder(Mesh& mesh, const Vec3& origin, const Fineness& fineness)
      : mesh_(mesh), origin_(origin), fineness_(fineness) {}

  void add_cylinder(const Vec3& base, const Vec3& top, double radius) {
    const Rim rim(base, top, fineness_.facets);
    add_side(base, top, radius, rim);
    add_disc(base, -rim.axis, 0.0, radius, rim);
    add_disc(top, rim.axis, 0.0, radius, rim);
  }

  /// One cylinder of a hollow tube: outside, bore, and a ring of wall at each free end. `at_base` and `at_top` are the
  /// directions in which other cylinders leave its ends; nothing of it reaches into their bores.
  void add_pipe(const Vec3& base, const Vec3& top, double radius, double bore_radius, const std::vector<Vec3>& at_base,
                const std::vector<Vec3>& at_top) {
    const Rim rim(base, top, fineness_.facets);
    if (at_base.empty()) add_disc(base, -rim.axis, bore_radius, radius, rim);
    if (at_top.empty()) add_disc(top, rim.axis, bore_radius, radius, rim);
    const double length = (top - base).norm();
    const int steps = steps_over(length);
    const auto add_mitred_side = [&](double side_radius, double facing) {
      add_patch(fineness_.facets, steps, [&](int facet, int step) -> Vertex {
        const Vec3 offset = side_radius * rim.outward(facet);
        const double from = std::min(mitre(offset, rim.axis, at_base), length);
        const double to = std::max(length - mitre(offset, -rim.axis, at_top), from);
        return vertex(base + offset + rim.axis * (from + (to - from) * step / steps), facing * rim.outward(facet));
      });
    };
    add_mitred_side(radius, 1.0);
    add_mitred_side(bore_radius, -1.0);
  }

  /// The part of a hollow tube's joint that lies in none of its cylinders, whose directions are `arms`: outside and in the
  /// bore.
  void add_pipe_joint(const Vec3& center, double radius, double bore_radius, const std::vector<Vec3>& arms) {
    const int rings = std::max(fineness_.facets / 2, 2);
    const auto add_part = [&](double part_radius, double facing) {
      add_patch(
          fineness_.facets, rings,
          [&](int facet, int ring) -> Vertex {
            const Vec3 outward = moved_off_cylinders(on_unit_sphere(facet, ring, rings), arms);
            return vertex(center + part_radius * outward, facing * outward);
          },
          [](const Vertex& vertex) { return !vertex.normal.isZero(); });
    };
    add_part(radius, 1.0);
    add_part(bore_radius, -1.0);
  }

  void add_sphere(const Vec3& center, double radius) {
    const int rings = std::max(fineness_.facets / 2, 2);
    add_patch(fineness_.facets, rings, [&](int facet, int ring) -> Vertex {
      const Vec3 normal = on_unit_sphere(facet, ring, rings);
      return vertex(center + radius * normal, normal);
    });
  }

  /// The face of a box across `axis`, at its upper or lower side.
  void add_face(const scene::BinPart& part, int axis, bool upper) {
    const scene::Box& box = part.box;
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    const Vec3 size = box.sizes();
    const int columns = steps_over(size[j]), rows = steps_over(size[k]);
    const Vec3 normal = part.world_from_part.linear() * Vec3::Unit(axis) * (upper ? 1.0 : -1.0);
    add_patch(columns, rows, [&](int column, int row) -> Vertex {
      Vec3 position = upper ? box.max() : box.min();
      // Counter-clockwise as seen from outside.
      position[j] = box.min()[j] + size[j] * (upper ? column : columns - column) / columns;
      position[k] = box.min()[k] + size[k] * row / rows;
      return vertex(part.world_from_part * position, normal);
    });
  }

 private:
  /// A cylinder's cross-section.
  struct Rim {
    Rim(const Vec3& base, const Vec3& top, int facet_count)
        : axis((top - base).normalized()), u(axis.unitOrthogonal()), v(axis.cross(u)), facets(facet_count) {}

    Vec3 outward(int facet) const {
      const double angle = 2.0 * std::numbers::pi * facet / facets;
      return std::cos(angle) * u + std::sin(angle) * v;
    }

    Vec3 axis, u, v;
    int facets;
  };

  Vec3 on_unit_sphere(int facet, int ring, int rings) const {
    const double longitude = 2.0 * std::numbers::pi * facet / fineness_.facets;
    const double polar = std::numbers::pi * ring / rings;
    return {std::sin(polar) * std::cos(longitude), std::sin(polar) * std::sin(longitude), std::cos(polar)};
  }

  /// A point of the unit sphere that lies just within a cylinder (a half-space of an arm's direction) goes to the border
  /// of those that lie in none; zero where that is far.
  static Vec3 moved_off_cylinders(Vec3 outward, const std::vector<Vec3>& arms) {
    constexpr double kFar = 0.5;
    constexpr double kNone = 1e-3;
    constexpr int kIterations = 30;
    const auto deepest = [&] {
      return *std::ranges::max_element(arms, {}, [&](const Vec3& arm) { return arm.dot(outward); });
    };
    if (deepest().dot(outward) > kFar) return Vec3::Zero();
    for (int i = 0; i < kIterations; ++i) {
      const Vec3 arm = deepest();
      if (arm.dot(outward) <= 0.0) return outward;
      outward = (outward - arm.dot(outward) * arm).normalized();
    }
    return deepest().dot(outward) < kNone ? outward : Vec3::Zero();
  }

  /// Where a line of a cylinder's side leaves its neighbours: equal cylinders meet in the plane that bisects their
  /// axes. `axis` points into the cylinder.
  static double mitre(const Vec3& offset, const Vec3& axis, const std::vector<Vec3>& neighbours) {
    constexpr double kOverlap = 0.03;  // of the radius, so that no crack shows between facets
    if (neighbours.empty()) return 0.0;
    double start = 0.0;
    for (const Vec3& direction : neighbours) {
      const double spread = 1.0 - direction.dot(axis);
      if (spread > 1e-9) start = std::max(start, direction.dot(offset) / spread);
    }
    return start - kOverlap * offset.norm();
  }

  void add_side(const Vec3& base, const Vec3& top, double radius, const Rim& rim) {
    const int steps = steps_over((top - base).norm());
    add_patch(fineness_.facets, steps, [&](int facet, int step) -> Vertex {
      return vertex(base + (top - base) * step / steps + radius * rim.outward(facet), rim.outward(facet));
    });
  }

  /// A flat ring, or a whole disc where the inner radius is 0.
  void add_disc(const Vec3& center, const Vec3& normal, double inner_radius, double radius, const Rim& rim) {
    add_patch(fineness_.facets, 1, [&](int facet, int outer) -> Vertex {
      return vertex(center + (outer ? radius : inner_radius) * rim.outward(facet), normal);
    });
  }

  std::uint32_t next_index() const { return static_cast<std::uint32_t>(mesh_.vertices.size()); }

  Vertex vertex(const Vec3& position, const Vec3& normal) const {
    return {(position - origin_).cast<float>(), normal.cast<float>()};
  }

  int steps_over(double length) const {
    constexpr double kMostSteps = 200.0;
    return static_cast<int>(std::clamp(std::ceil(length / fineness_.cell), 1.0, kMostSteps));
  }

  /// columns x rows quads over vertices vertex_at(0..columns, 0..rows); triangles stay whose vertices
  /// are all kept.
  template <typename VertexAt, typename IsKept>
  void add_patch(int columns, int rows, const VertexAt& vertex_at, const IsKept& is_kept) {
    const std::uint32_t first = next_index();
    for (int column = 0; column <= columns; ++column)
      for (int row = 0; row <= rows; ++row) mesh_.vertices.push_back(vertex_at(column, row));
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      if (is_kept(mesh_.vertices[a]) && is_kept(mesh_.vertices[b]) && is_kept(mesh_.vertices[c]))
        mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
    };
    for (int column = 0; column < columns; ++column) {
      for (int row = 0; row < rows; ++row) {
        const std::uint32_t here = first + static_cast<std::uint32_t>(column * (rows + 1) + row);
        const std::uint32_t beside = here + static_cast<std::uint32_t>(rows) + 1;
        add(here, beside, here + 1);
        add(here + 1, beside, beside + 1);
      }
    }
  }
  template <typename VertexAt>
  void add_patch(int columns, int rows, const VertexAt& vertex_at) {
    add_patch(columns, rows, vertex_at, [](const Vertex&) { return true; });
  }

  Mesh& mesh_;
  Vec3 origin_;
  Fineness fineness_;
};

}  // namespace

namespace {

/// In world axes.
std::vector<Vec3> arms_in_world(const scene::PlacedTube& placed, int node,
                                std::size_t except = static_cast<std::size_t>(-1)) {
  std::vector<Vec3> arms = placed.tube.directions_from(node, except);
  for (Vec3& arm : arms) arm = placed.world_from_tube.linear() * arm;
  return arms;
}

void add_pipes(const scene::PlacedTube& placed, const tube::TubeSolids& solids, MeshBuilder& builder) {
  for (std::size_t i = 0; i < solids.cylinders.size(); ++i) {
    const tube::SolidCylinder& pipe = solids.cylinders[i];
    builder.add_pipe(pipe.a, pipe.b, pipe.radius, pipe.bore_radius, arms_in_world(placed, pipe.node_a, i),
                     arms_in_world(placed, pipe.node_b, i));
  }
  for (const tube::JointSphere& joint : solids.joints)
    builder.add_pipe_joint(joint.center, joint.radius, joint.bore_radius, arms_in_world(placed, joint.node));
}

void add_solids(const tube::TubeSolids& solids, MeshBuilder& builder) {
  for (const tube::SolidCylinder& cylinder : solids.cylinders)
    builder.add_cylinder(cylinder.a, cylinder.b, cylinder.radius);
  for (const tube::JointSphere& joint : solids.joints) builder.add_sphere(joint.center, joint.radius);
}

}  // namespace

Mesh tube_mesh(const scene::PlacedTube& placed, const Vec3& origin, const Fineness& fineness) {
  Mesh mesh;
  MeshBuilder builder(mesh, origin, fineness);
  const tube::TubeSolids solids = placed.solids_in_world();
  if (solids.has_open_end()) add_pipes(placed, solids, builder);
  else add_solids(solids, builder);
  return mesh;
}

Mesh surroundings_mesh(const scene::Scene& scene, const Vec3& origin, const Fineness& fineness) {
  Mesh mesh;
  MeshBuilder builder(mesh, origin, fineness);
  for (const scene::BinPart& part : scene::surrounding_boxes(scene)) add_part(part, origin, fineness, mesh);
  for (const scene::StandingCylinder& cylinder : scene::surrounding_cylinders(scene))
    builder.add_cylinder(cylinder.position, cylinder.position + cylinder.height * Vec3::UnitZ(), cylinder.radius);
  return mesh;
}

void add_triangles(const std::vector<scene::Triangle>& triangles, const Vec3& origin, const Vec3& eye, Mesh& mesh) {
  for (const scene::Triangle& triangle : triangles) {
    const bool faces_eye = triangle.normal().dot(eye - triangle.corners[0]) >= 0.0;
    const Vec3 normal = (faces_eye ? 1.0 : -1.0) * triangle.normal();
    for (const int corner : {0, faces_eye ? 1 : 2, faces_eye ? 2 : 1}) {
      const Vec3 position = triangle.corners[static_cast<std::size_t>(corner)] - origin;
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
      mesh.vertices.push_back({position.cast<float>(), normal.cast<float>()});
    }
  }
}

void add_part(const scene::BinPart& part, const Vec3& origin, const Fineness& fineness, Mesh& mesh) {
  MeshBuilder builder(mesh, origin, fineness);
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) builder.add_face(part, axis, upper);
}

}  // namespace tubebin::render
