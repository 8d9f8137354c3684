/// A point cloud as every stage passes it on.
#pragma once

#include <cstdint>
#include <vector>

#include "tubebin/core/geometry.hpp"

namespace tubebin::cloud {

using Point = Eigen::Vector3f;

/// Colours are 0x00RRGGBB. Label 0 is the bin, label k tube k.
using Color = std::uint32_t;
using Label = std::uint32_t;

/// The colour of a point without a tube; never a tube's or the bin's.
constexpr Color kNullColor = 0x000000;

/// Points in the world frame (metres), row by row where organized; colours, labels and sources are empty or one a point.
/// In an organized cloud a pixel that hit nothing has NaN coordinates, null colour and label 0.
struct Cloud {
  std::uint32_t width = 0;
  std::uint32_t height = 1;  ///< 1: not organized
  std::vector<Point> points;
  std::vector<Color> colors;
  std::vector<Label> labels;
  std::vector<std::uint32_t> sources;         ///< which of several scanners saw each point, from 0
  Pose world_from_sensor = Pose::Identity();  ///< PCD's VIEWPOINT; that of source 0

  std::size_t size() const { return points.size(); }
  bool organized() const { return height > 1; }
};

inline bool is_finite(const Point& point) { return point.allFinite(); }

}  // namespace tubebin::cloud
