/// The points that a 3D view shows, as the page holds them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tubebin/evaluation/scene_view.hpp"

namespace tubebin::evaluation {

struct ViewedPoints {
  std::vector<std::size_t> chosen;  ///< of the cloud's finite points, ascending
  std::string note;                 ///< how many of how many
  Eigen::AlignedBox3d box;
};

/// Evenly, points on tubes before what lies around them. Throws IoError where there is no finite point.
ViewedPoints choose_points(const LabelledPoints& points);

/// As view_data.hpp says.
std::string encode_points(const LabelledPoints& points, const ViewedPoints& viewed,
                          std::span<const std::uint16_t> kinds);

}  // namespace tubebin::evaluation
