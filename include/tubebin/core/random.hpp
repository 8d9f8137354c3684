/// Seeded randomness with the same numbers on every platform: the engine is standardized, the standard
/// library's distributions are not, so the few that are needed are here.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <random>

#include "tubebin/core/geometry.hpp"

namespace tubebin {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  /// Uniform in [low, high).
  double uniform(double low, double high);
  /// Uniform in {low, ..., high}, both included; low <= high.
  int integer(int low, int high);
  /// Normal with mean 0 and standard deviation 1 (Box-Muller).
  double normal();
  /// Uniform over all rotations (Shoemake 1992, "Uniform random rotations").
  Quat rotation();

 private:
  std::mt19937_64 engine_;
};

/// A seed derived from others, so that every scene and every attempt has its own stream (SplitMix64 mixing).
std::uint64_t derive_seed(std::initializer_list<std::uint64_t> parts);

}  // namespace tubebin
