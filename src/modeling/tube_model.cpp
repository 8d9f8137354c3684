#include "tubebin/modeling/tube_model.hpp"

#include <algorithm>
#include <cmath>

namespace tubebin::modeling {

double rounded(double metres) { return std::round(metres * 1e7) / 1e7; }

void round_tubes(std::vector<TubeModel>& tubes) {
  for (TubeModel& tube : tubes) {
    tube.radius = rounded(tube.radius);
    for (TubePath& path : tube.paths)
      for (Vec3& node : path.nodes) node = node.unaryExpr(&rounded);
  }
}

void turn_about(TubePath& path) {
  std::reverse(path.nodes.begin(), path.nodes.end());
  std::reverse(path.bridged.begin(), path.bridged.end());
  std::reverse(path.bridge_odds.begin(), path.bridge_odds.end());
}

double polyline_length(const std::vector<Vec3>& nodes) {
  double sum = 0.0;
  for (std::size_t i = 1; i < nodes.size(); ++i) sum += (nodes[i] - nodes[i - 1]).norm();
  return sum;
}

double longest_step(const std::vector<Vec3>& nodes) {
  double squared = 0.0;
  for (std::size_t i = 1; i < nodes.size(); ++i) squared = std::max(squared, (nodes[i] - nodes[i - 1]).squaredNorm());
  return std::sqrt(squared);
}

Eigen::AlignedBox3d box_of(std::span<const Vec3> nodes) {
  Eigen::AlignedBox3d box;
  for (const Vec3& node : nodes) box.extend(node);
  return box;
}

Vec3 nearest_on_polyline(const Vec3& point, std::span<const Vec3> nodes) {
  Vec3 nearest = nodes.front();
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const Vec3 axis = nodes[k + 1] - nodes[k];
    const double t = std::clamp((point - nodes[k]).dot(axis) / std::max(axis.squaredNorm(), 1e-18), 0.0, 1.0);
    const Vec3 foot = nodes[k] + t * axis;
    if ((point - foot).squaredNorm() < (point - nearest).squaredNorm()) nearest = foot;
  }
  return nearest;
}

double distance_to_polyline(const Vec3& point, std::span<const Vec3> nodes) {
  return (point - nearest_on_polyline(point, nodes)).norm();
}

double TubePiece::length() const { return polyline_length(nodes); }

double TubeModel::length() const {
  double sum = 0.0;
  for (const TubePath& path : paths) sum += polyline_length(path.nodes);
  return sum;
}

std::size_t TubeModel::cylinder_count() const {
  std::size_t count = 0;
  for (const TubePath& path : paths) count += path.nodes.size() - 1;
  return count;
}

}  // namespace tubebin::modeling
