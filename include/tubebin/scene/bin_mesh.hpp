/// A bin's surfaces as triangles, read from an STL file.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tubebin/core/geometry.hpp"

namespace tubebin::scene {

/// Corners in metres, bin frame.
struct Triangle {
  std::array<Vec3, 3> corners;

  /// Unit.
  Vec3 normal() const;
  /// The triangle's point nearest to `point`.
  Vec3 project(const Vec3& point) const;
};

constexpr std::size_t kMeshTrianglesMax = 300000;

struct BinMesh {
  std::vector<Triangle> triangles;  ///< without those that have no area
  Eigen::AlignedBox3d bounds;
  std::string stl;   ///< the file's bytes
  std::string path;  ///< of that file, as messages name it

  /// "bin-<XXH3 128-bit hash of the file>.stl", what a data set calls its copy.
  std::string file_name() const;
};

/// Binary or ASCII STL, whose numbers times `scale` are metres in the bin's frame. Throws IoError that names the file, the
/// byte or line, the value and what would be right.
BinMesh parse_stl(std::string stl, const std::string& name, double scale);

}  // namespace tubebin::scene
