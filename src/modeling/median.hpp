#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tubebin::modeling {

/// The upper median of at least one value, which are reordered.
template <typename Value>
Value median(std::vector<Value>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace tubebin::modeling
