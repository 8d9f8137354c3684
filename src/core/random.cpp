#include "tubebin/core/random.hpp"

#include <cmath>

namespace tubebin {

double Random::uniform(double low, double high) {
  const double unit = static_cast<double>(engine_() >> 11) * 0x1.0p-53;
  return low + (high - low) * unit;
}

int Random::integer(int low, int high) {
  const auto span = static_cast<std::uint64_t>(static_cast<std::int64_t>(high) - low) + 1;
  // Rejection keeps every value equally likely: 2^64 is no multiple of most spans.
  const std::uint64_t limit = UINT64_MAX - UINT64_MAX % span;
  std::uint64_t value = engine_();
  while (value >= limit) value = engine_();
  return static_cast<int>(low + static_cast<std::int64_t>(value % span));
}

double Random::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
  return radius * std::cos(uniform(0.0, 2.0 * std::numbers::pi));
}

Quat Random::rotation() {
  const double u = uniform(0.0, 1.0);
  const double a = uniform(0.0, 2.0 * std::numbers::pi);
  const double b = uniform(0.0, 2.0 * std::numbers::pi);
  return Quat(std::sqrt(u) * std::cos(b), std::sqrt(1.0 - u) * std::sin(a), std::sqrt(1.0 - u) * std::cos(a),
              std::sqrt(u) * std::sin(b));
}

std::uint64_t derive_seed(std::initializer_list<std::uint64_t> parts) {
  std::uint64_t state = 0;
  for (const std::uint64_t part : parts) {
    state += part + 0x9e3779b97f4a7c15ULL;
    state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9ULL;
    state = (state ^ (state >> 27)) * 0x94d049bb133111ebULL;
    state ^= state >> 31;
  }
  return state;
}

}  // namespace tubebin
