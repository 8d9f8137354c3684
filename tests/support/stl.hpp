// STL files of boxes.
#pragma once

#include <fmt/format.h>

#include <cstring>
#include <string>
#include <vector>

#include "tubebin/scene/scene.hpp"

namespace tubebin::testing {

/// The twelve triangles of each box.
inline std::vector<std::array<Vec3, 3>> triangles_of(const std::vector<scene::BinPart>& parts) {
  constexpr std::size_t kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                        {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  std::vector<std::array<Vec3, 3>> triangles;
  for (const scene::BinPart& part : parts) {
    const std::array<Vec3, 8> corners = part.corners_in_world();
    for (const auto& [a, b, c, d] : kFaces) {
      triangles.push_back({corners[a], corners[b], corners[c]});
      triangles.push_back({corners[a], corners[c], corners[d]});
    }
  }
  return triangles;
}

inline std::string ascii_stl(const std::vector<std::array<Vec3, 3>>& triangles, double units_per_metre = 1.0) {
  std::string stl = "solid a bin\n";
  for (const auto& triangle : triangles) {
    stl += "facet normal 0 0 0\n outer loop\n";
    for (const Vec3& p : triangle)
      stl +=
          fmt::format("  vertex {} {} {}\n", p.x() * units_per_metre, p.y() * units_per_metre, p.z() * units_per_metre);
    stl += " endloop\nendfacet\n";
  }
  return stl + "endsolid a bin\n";
}

inline std::string binary_stl(const std::vector<std::array<Vec3, 3>>& triangles) {
  std::string stl(80, ' ');
  const auto append = [&](const auto& value) { stl.append(reinterpret_cast<const char*>(&value), sizeof value); };
  append(static_cast<std::uint32_t>(triangles.size()));
  for (const auto& triangle : triangles) {
    stl.append(12, '\0');
    for (const Vec3& p : triangle)
      for (const double value : p) append(static_cast<float>(value));
    stl.append(2, '\0');
  }
  return stl;
}

}  // namespace tubebin::testing
