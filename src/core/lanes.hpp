// Eight numbers at a time, for functions that are TUBEBIN_WIDE.
#pragma once

#include <cmath>
#include <cstdint>

#include "tubebin/core/wide.hpp"

namespace tubebin {

constexpr std::uint32_t kLanes = 8;
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));
using Mask = std::int32_t __attribute__((vector_size(kLanes * sizeof(float))));

// By reference: how such values are passed depends on the processor that a function is compiled for.

inline void load(Lanes& lanes, const float* numbers) { __builtin_memcpy(&lanes, numbers, sizeof lanes); }

inline void take_root(Lanes& lanes) {
  for (std::uint32_t k = 0; k < kLanes; ++k) lanes[k] = std::sqrt(lanes[k]);
}

inline float sum_of(const Lanes& v) { return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7])); }

}  // namespace tubebin
