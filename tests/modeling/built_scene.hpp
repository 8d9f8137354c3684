/// Scenes built by hand for the modeler, scanned, and what the modeler makes of them.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "tubebin/core/random.hpp"
#include "tubebin/modeling/pipeline.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin::modeling {

constexpr double kRadius = 0.0125;  // metres

inline scene::PlacedTube tube_along(const std::vector<Vec3>& nodes) {
  tube::Tube tube{.radius = kRadius, .mass = 0.055, .nodes = nodes, .cylinders = {}};
  for (int i = 0; i + 1 < static_cast<int>(nodes.size()); ++i) tube.cylinders.push_back({i, i + 1, i});
  return {tube, Pose::Identity()};
}

inline scene::Scene scene_of(std::vector<scene::PlacedTube> tubes) {
  scene::Scene scene;
  scene.tubes = std::move(tubes);
  return scene;
}

/// At the middle of the bin's floor.
inline scene::Scanner looking_from(const Vec3& position) {
  scene::Scanner scanner;
  scanner.position = position;
  scanner.rotation_deg = scene::rotation_deg_towards(Vec3::Zero(), position);
  scanner.width = 960, scanner.height = 600;
  scanner.horizontal_fov_deg = 45.0;
  return scanner;
}

/// Moves every point along its ray by normal noise of `sigma` metres.
inline void add_range_noise(cloud::Cloud& cloud, double sigma, std::uint64_t seed) {
  Random random(seed);
  const Vec3 eye = cloud.world_from_sensor.translation();
  for (cloud::Point& point : cloud.points) {
    if (!cloud::is_finite(point)) continue;
    const Vec3 p = point.cast<double>();
    point = (p + (p - eye).normalized() * sigma * random.normal()).cast<float>();
  }
}

inline ModelingInput input_of(const cloud::Cloud& cloud, const scene::Bin& bin) {
  return {.points = cloud.points, .world_from_sensor = cloud.world_from_sensor, .bin = bin};
}

inline ModelingOptions known_radius(ModelingMethod method = ModelingMethod::centerline) {
  ModelingOptions options;
  options.method = method;
  options.radius = kRadius;
  return options;
}

/// Equation 1 for a result, from the cloud's own labels.
inline double micro_recall_of(const ModelingResult& result, const cloud::Cloud& cloud) {
  std::vector<std::vector<std::int64_t>> table(64, std::vector<std::int64_t>(result.tubes.size() + 1, 0));
  for (std::size_t i = 0; i < result.source.size(); ++i) ++table[cloud.labels[result.source[i]]][result.labels[i]];
  // Few tubes: the best matching by trying all assignments of tubes to rows, one row after the other.
  std::vector<bool> used(result.tubes.size() + 1, false);
  const auto best = [&](const auto& self, std::size_t row) -> std::int64_t {
    if (row == table.size()) return 0;
    if (std::accumulate(table[row].begin(), table[row].end(), std::int64_t{0}) == 0) return self(self, row + 1);
    std::int64_t most = self(self, row + 1);
    for (std::size_t column = 1; column < used.size(); ++column) {
      if (used[column] || table[row][column] == 0) continue;
      used[column] = true;
      most = std::max(most, table[row][column] + self(self, row + 1));
      used[column] = false;
    }
    return most;
  };
  const std::int64_t correct_most = best(best, 0);
  return static_cast<double>(correct_most) / static_cast<double>(result.source.size());
}

/// Farthest that any node of the model lies from the tube's centreline, bridges left out, metres.
inline double farthest_node(const TubeModel& model, const scene::PlacedTube& tube) {
  std::vector<Vec3> nodes;
  for (int i = 0; i < static_cast<int>(tube.tube.nodes.size()); ++i) nodes.push_back(tube.node_in_world(i));
  double farthest = 0.0;
  for (const Vec3& node : model.paths.front().nodes) farthest = std::max(farthest, distance_to_polyline(node, nodes));
  return farthest;
}

/// A tube of five cylinders in a line.
inline scene::PlacedTube straight_tube(const Vec3& from, const Vec3& to) {
  std::vector<Vec3> nodes;
  for (int i = 0; i <= 5; ++i) nodes.push_back(from + (to - from) * i / 5.0);
  return tube_along(nodes);
}

/// A tube across three others that lie on the floor.
inline scene::Scene one_over_three() {
  return scene_of({straight_tube({-0.2, 0, 3 * kRadius}, {0.2, 0, 3 * kRadius}),
                   straight_tube({-0.12, -0.15, kRadius}, {-0.12, 0.15, kRadius}),
                   straight_tube({0.0, -0.15, kRadius}, {0.0, 0.15, kRadius}),
                   straight_tube({0.12, -0.15, kRadius}, {0.12, 0.15, kRadius})});
}

}  // namespace tubebin::modeling
