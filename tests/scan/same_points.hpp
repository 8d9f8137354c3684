// Clouds whose points are the same bytes, numbers and what is none alike.
#pragma once

#include <cstring>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::testing {

inline bool same_points(const cloud::Cloud& a, const cloud::Cloud& b) {
  return a.size() == b.size() && std::memcmp(a.points.data(), b.points.data(), a.size() * sizeof(cloud::Point)) == 0;
}

}  // namespace tubebin::testing
