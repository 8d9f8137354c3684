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

double Tube::length() const {
  double sum = 0.0;
  for (const Cylinder& cylinder : cylinders) sum += length(cylinder);
  return sum;
}

}  // namespace tubebin
