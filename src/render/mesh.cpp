#include "render/mesh.hpp"

#include <algorithm>
#include <cmath>

namespace tubebin {
namespace {

class MeshBuilder {
 public:
  MeshBuilder(Mesh& mesh, const Vec3& origin, const Fineness& fineness)
      : mesh_(mesh), origin_(origin), fineness_(fineness) {}

  void add_cylinder(const Vec3& base, const Vec3& top, double radius) {
    const Vec3 axis = (top - base).normalized();
    const Vec3 u = axis.unitOrthogonal();
    const Vec3 v = axis.cross(u);
    const auto outward = [&](int facet) -> Vec3 {
      const double angle = 2.0 * std::numbers::pi * facet / fineness_.facets;
      return std::cos(angle) * u + std::sin(angle) * v;
    };
    const int steps = steps_over((top - base).norm());
    add_patch(fineness_.facets, steps, [&](int facet, int step) -> Vertex {
      return vertex(base + (top - base) * step / steps + radius * outward(facet), outward(facet));
    });
    add_cap(base, -axis, radius, outward);
    add_cap(top, axis, radius, outward);
  }

  void add_sphere(const Vec3& center, double radius) {
    const int rings = std::max(fineness_.facets / 2, 2);
    add_patch(fineness_.facets, rings, [&](int facet, int ring) -> Vertex {
      const double longitude = 2.0 * std::numbers::pi * facet / fineness_.facets;
      const double polar = std::numbers::pi * ring / rings;
      const Vec3 normal(std::sin(polar) * std::cos(longitude), std::sin(polar) * std::sin(longitude), std::cos(polar));
      return vertex(center + radius * normal, normal);
    });
  }

  /// The face of a box across `axis`, at its upper or lower side.
  void add_face(const Box& box, int axis, bool upper) {
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    const Vec3 size = box.sizes();
    const int columns = steps_over(size[j]), rows = steps_over(size[k]);
    const Vec3 normal = Vec3::Unit(axis) * (upper ? 1.0 : -1.0);
    add_patch(columns, rows, [&](int column, int row) -> Vertex {
      Vec3 position = upper ? box.max() : box.min();
      // Counter-clockwise as seen from outside.
      position[j] = box.min()[j] + size[j] * (upper ? column : columns - column) / columns;
      position[k] = box.min()[k] + size[k] * row / rows;
      return vertex(position, normal);
    });
  }

 private:
  std::uint32_t next_index() const { return static_cast<std::uint32_t>(mesh_.vertices.size()); }

  Vertex vertex(const Vec3& position, const Vec3& normal) const {
    return {(position - origin_).cast<float>(), normal.cast<float>()};
  }

  int steps_over(double length) const {
    constexpr double kMostSteps = 200.0;
    return static_cast<int>(std::clamp(std::ceil(length / fineness_.cell), 1.0, kMostSteps));
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
  }

  /// columns x rows quads over vertices vertex_at(0..columns, 0..rows).
  template <typename VertexAt>
  void add_patch(int columns, int rows, const VertexAt& vertex_at) {
    const std::uint32_t first = next_index();
    for (int column = 0; column <= columns; ++column)
      for (int row = 0; row <= rows; ++row) mesh_.vertices.push_back(vertex_at(column, row));
    for (int column = 0; column < columns; ++column) {
      for (int row = 0; row < rows; ++row) {
        const std::uint32_t here = first + static_cast<std::uint32_t>(column * (rows + 1) + row);
        const std::uint32_t beside = here + static_cast<std::uint32_t>(rows) + 1;
        add_triangle(here, beside, here + 1);
        add_triangle(here + 1, beside, beside + 1);
      }
    }
  }

  template <typename Outward>
  void add_cap(const Vec3& center, const Vec3& normal, double radius, const Outward& outward) {
    const std::uint32_t middle = next_index();
    mesh_.vertices.push_back(vertex(center, normal));
    for (int facet = 0; facet <= fineness_.facets; ++facet)
      mesh_.vertices.push_back(vertex(center + radius * outward(facet), normal));
    for (std::uint32_t facet = 1; facet <= static_cast<std::uint32_t>(fineness_.facets); ++facet)
      add_triangle(middle, middle + facet, middle + facet + 1);
  }

  Mesh& mesh_;
  Vec3 origin_;
  Fineness fineness_;
};

}  // namespace

Mesh tube_mesh(const PlacedTube& placed, const Vec3& origin, const Fineness& fineness) {
  Mesh mesh;
  MeshBuilder builder(mesh, origin, fineness);
  const Tube& tube = placed.tube;
  for (const Cylinder& cylinder : tube.cylinders)
    builder.add_cylinder(placed.node_in_world(cylinder.node_a), placed.node_in_world(cylinder.node_b), tube.radius);
  const std::vector<int> degrees = tube.node_degrees();
  for (int node = 0; node < static_cast<int>(degrees.size()); ++node)
    if (degrees[static_cast<std::size_t>(node)] != 1) builder.add_sphere(placed.node_in_world(node), tube.radius);
  return mesh;
}

void add_box(const Box& box, const Vec3& origin, const Fineness& fineness, Mesh& mesh) {
  MeshBuilder builder(mesh, origin, fineness);
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) builder.add_face(box, axis, upper);
}

}  // namespace tubebin
