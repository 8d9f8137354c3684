/// Random orders.
#pragma once

#include <utility>
#include <vector>

#include "tubebin/core/random.hpp"

namespace tubebin {

/// Fisher and Yates: every order is as likely.
template <typename T>
void shuffle(std::vector<T>& values, Random& random) {
  for (int i = static_cast<int>(values.size()) - 1; i > 0; --i)
    std::swap(values[static_cast<std::size_t>(i)], values[static_cast<std::size_t>(random.integer(0, i))]);
}

}  // namespace tubebin
