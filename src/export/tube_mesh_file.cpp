#include "export/tube_mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/mesh.hpp"

namespace tubebin::exports {
namespace {

/// At most 0.5 % of the radius off, 0.06 mm of the paper's tubes.
constexpr render::Fineness kFineness = {.facets = 32};

template <typename Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Between any two points. Two are no farther apart than both are from the middle together, so points are taken from the
/// outside in, until that bound is below the largest distance found.
double largest_distance(std::vector<Eigen::Vector3f> points) {
  Eigen::AlignedBox3f bounds;
  for (const Eigen::Vector3f& point : points) bounds.extend(point);
  const Eigen::Vector3f middle = bounds.center();
  const auto reach = [&](const Eigen::Vector3f& point) { return (point - middle).norm(); };
  std::ranges::sort(points, [&](const auto& a, const auto& b) { return reach(a) > reach(b); });
  std::vector<float> reaches;
  for (const Eigen::Vector3f& point : points) reaches.push_back(reach(point) * (1.0F + 1e-6F));  // rounded up
  float largest = 0.0F;
  for (std::size_t i = 0; i < points.size() && 2.0F * reaches[i] > largest; ++i)
    for (std::size_t j = i + 1; j < points.size() && reaches[i] + reaches[j] > largest; ++j)
      largest = std::max(largest, (points[i] - points[j]).norm());
  return static_cast<double>(largest);
}

/// Without the vertices that no triangle has: where a joint's sphere lies within a pipe, nothing of it is kept.
render::Mesh without_unused(const render::Mesh& mesh) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> places(mesh.vertices.size(), kNone);
  render::Mesh used;
  for (const std::uint32_t index : mesh.indices) {
    if (places[index] == kNone) {
      places[index] = static_cast<std::uint32_t>(used.vertices.size());
      used.vertices.push_back(mesh.vertices[index]);
    }
    used.indices.push_back(places[index]);
  }
  return used;
}

render::Mesh mesh_of(const tube::Tube& tube) {
  return render::tube_mesh({tube, Pose::Identity()}, Vec3::Zero(), kFineness);
}

}  // namespace

TubeMeshFile tube_mesh_file(const tube::Tube& tube) {
  const render::Mesh mesh = without_unused(mesh_of(tube));
  TubeMeshFile file;
  file.ply = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment millimetres\nelement vertex {}\nproperty float x\n"
      "property float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(), mesh.indices.size() / 3);
  std::vector<Eigen::Vector3f> points_mm;
  for (const render::Vertex& vertex : mesh.vertices) {
    points_mm.push_back(1000.0F * vertex.position);
    for (int i = 0; i < 3; ++i) append(file.ply, points_mm.back()[i]);
    for (int i = 0; i < 3; ++i) append(file.ply, vertex.normal[i]);
    file.bounds_mm.extend(points_mm.back().cast<double>());
  }
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    append(file.ply, std::uint8_t{3});
    for (std::size_t corner = 0; corner < 3; ++corner)
      append(file.ply, static_cast<std::int32_t>(mesh.indices[i + corner]));
  }
  file.diameter_mm = largest_distance(points_mm);
  return file;
}

std::string tube_stl(const tube::Tube& tube) {
  constexpr std::size_t kHeaderBytes = 80;
  const render::Mesh mesh = mesh_of(tube);
  std::string stl = "a tube, metres";
  stl.resize(kHeaderBytes, ' ');
  append(stl, static_cast<std::uint32_t>(mesh.indices.size() / 3));
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::array<Eigen::Vector3f, 3> corners;
    for (std::size_t corner = 0; corner < 3; ++corner)
      corners[corner] = mesh.vertices[mesh.indices[i + corner]].position;
    const Eigen::Vector3f normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    for (const Eigen::Vector3f& vector : {normal, corners[0], corners[1], corners[2]})
      for (int axis = 0; axis < 3; ++axis) append(stl, vector[axis]);
    append(stl, std::uint16_t{0});
  }
  return stl;
}

}  // namespace tubebin::exports
