#include "export/tube_mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/mesh.hpp"

namespace tubebin::exports {
namespace {

/// At most 0.5 % of the radius off, 0.06 mm of the paper's tubes.
constexpr render::Fineness kFineness = {.facets = 32};

template <typename Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

double largest_distance(const std::vector<Eigen::Vector3f>& points) {
  float squared = 0.0F;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      squared = std::max(squared, (points[i] - points[j]).squaredNorm());
  return std::sqrt(static_cast<double>(squared));
}

}  // namespace

TubeMeshFile tube_mesh_file(const tube::Tube& tube) {
  const render::Mesh mesh = render::tube_mesh({tube, Pose::Identity()}, Vec3::Zero(), kFineness);
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

}  // namespace tubebin::exports
