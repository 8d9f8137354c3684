#include "tubebin/modeling/tube_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tubebin {

double polyline_length(const std::vector<Vec3>& nodes) {
  double sum = 0.0;
  for (std::size_t i = 1; i < nodes.size(); ++i) sum += (nodes[i] - nodes[i - 1]).norm();
  return sum;
}

double distance_to_polyline(const Vec3& point, const std::vector<Vec3>& nodes) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const Vec3 axis = nodes[k + 1] - nodes[k];
    const double t = std::clamp((point - nodes[k]).dot(axis) / std::max(axis.squaredNorm(), 1e-18), 0.0, 1.0);
    nearest = std::min(nearest, (point - nodes[k] - t * axis).squaredNorm());
  }
  return std::sqrt(nearest);
}

double TubePiece::length() const { return polyline_length(nodes); }
double TubeModel::length() const { return polyline_length(nodes); }

}  // namespace tubebin
