#include "tubebin/tube/tube.hpp"

namespace tubebin {

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

}  // namespace tubebin
