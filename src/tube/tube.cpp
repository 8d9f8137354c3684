#include "tubebin/tube/tube.hpp"

#include <algorithm>

namespace tubebin::tube {

std::vector<double> Tube::node_radii() const {
  std::vector<double> radii(nodes.size(), 0.0);
  for (const Cylinder& cylinder : cylinders)
    for (const int node : {cylinder.node_a, cylinder.node_b}) {
      double& of_node = radii[static_cast<std::size_t>(node)];
      of_node = std::max(of_node, radius_of(cylinder));
    }
  for (double& of_node : radii)
    if (of_node == 0.0) of_node = radius;
  return radii;
}

double Tube::radius_max() const {
  const std::vector<double> radii = node_radii();
  return radii.empty() ? radius : *std::ranges::max_element(radii);
}

std::vector<int> Tube::node_degrees() const {
  std::vector<int> degrees(nodes.size(), 0);
  for (const Cylinder& cylinder : cylinders) {
    ++degrees[static_cast<std::size_t>(cylinder.node_a)];
    ++degrees[static_cast<std::size_t>(cylinder.node_b)];
  }
  return degrees;
}

std::vector<Vec3> Tube::directions_from(int node, std::size_t except) const {
  std::vector<Vec3> directions;
  const Vec3& center = nodes[static_cast<std::size_t>(node)];
  for (std::size_t i = 0; i < cylinders.size(); ++i) {
    if (i == except) continue;
    const Cylinder& other = cylinders[i];
    if (other.node_a == node)
      directions.push_back((nodes[static_cast<std::size_t>(other.node_b)] - center).normalized());
    if (other.node_b == node)
      directions.push_back((nodes[static_cast<std::size_t>(other.node_a)] - center).normalized());
  }
  return directions;
}

double Tube::length() const {
  double sum = 0.0;
  for (const Cylinder& cylinder : cylinders) sum += length(cylinder);
  return sum;
}

}  // namespace tubebin::tube
