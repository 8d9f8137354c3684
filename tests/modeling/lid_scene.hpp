/// A view that hides one place and shows the rest to be empty, for what the joining stages may and may not believe.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "modeling/built_scene.hpp"
#include "modeling/joining/occlusion.hpp"

namespace tubebin::modeling {

constexpr double kSheetSpacing = 0.004;  // metres, of a built cloud's points

/// A level sheet of points about `center`.
inline void add_sheet(const Vec3& center, double half_size, std::vector<cloud::Point>& points) {
  for (double x = -half_size; x <= half_size; x += kSheetSpacing)
    for (double y = -half_size; y <= half_size; y += kSheetSpacing)
      points.push_back((center + Vec3(x, y, 0)).cast<float>());
}

/// What a scanner 2 m above that saw these points says.
inline OcclusionTest seen_from_above(const std::vector<cloud::Point>& points) {
  const Pose world_from_sensor = make_pose(Quat(0, 1, 0, 0), {0, 0, 2});
  const ModelingInput input{.points = points, .world_from_sensor = world_from_sensor, .bin = std::nullopt};
  return {input, {world_from_sensor, cloud::Point::Zero()}, kSheetSpacing, kRadius};
}

/// What a scanner 2 m above sees of a floor far below, and of a lid over the middle of the x axis.
class LidScene : public ::testing::Test {
 protected:
  LidScene() {
    add_sheet({0, 0, -0.3}, 0.6, points_);
    add_sheet({0, 0, 0.1}, 0.03, points_);
  }

  OcclusionTest occlusion() const { return seen_from_above(points_); }

  static TubePiece straight(double y, double x_from, double x_to) {
    return {.nodes = {{x_from, y, 0}, {(x_from + x_to) / 2, y, 0}, {x_to, y, 0}}, .radius = kRadius, .points = {}};
  }

 private:
  std::vector<cloud::Point> points_;
};

}  // namespace tubebin::modeling
