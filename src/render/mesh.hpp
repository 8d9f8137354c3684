// Triangles of tubes and boxes.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "tubebin/scene/scene.hpp"

namespace tubebin::render {

struct Vertex {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;
  float dome_light = 1.0F;  ///< what part of the sky's light arrives; lit pictures alone compute it
};

/// Three indices a triangle.
struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
};

/// How finely surfaces are divided. Flat and straight ones need no division for their shape, but to carry
/// light.
struct Fineness {
  int facets = 64;                                        ///< around a tube
  double cell = std::numeric_limits<double>::infinity();  ///< metres, largest step along flat and straight surfaces
};

/// Cylinders with flat caps and spheres at the joints, around `origin` in world axes. A hollow tube's free ends are open.
Mesh tube_mesh(const scene::PlacedTube& tube, const Vec3& origin, const Fineness& fineness);

/// What stands around the bin, around `origin` in world axes.
Mesh surroundings_mesh(const scene::Scene& scene, const Vec3& origin, const Fineness& fineness);

/// The faces of a bin's part, around `origin` in world axes.
void add_part(const scene::BinPart& part, const Vec3& origin, const Fineness& fineness, Mesh& mesh);

/// A bin's triangles around `origin` in world axes, each with the normal and winding of the side that one sees from `eye`.
void add_triangles(const std::vector<scene::Triangle>& triangles, const Vec3& origin, const Vec3& eye, Mesh& mesh);

}  // namespace tubebin::render
