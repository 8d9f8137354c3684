#include "physics/rest_proof.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>

namespace tubebin::physics {
namespace {

using Motion = std::function<Vec3(int step)>;

constexpr double kStep = 0.005;  // seconds

int steps_in(double seconds) { return static_cast<int>(std::lround(seconds / kStep)); }

/// The step at which one node that moves so, and may start from step `slow` on, is proven to be at rest.
std::optional<int> proven_at(const Motion& motion, int slow, const PhysicsOptions& options, double* drift = nullptr) {
  RestProof proof(options);
  for (int step = 1; step <= 4000; ++step) {
    proof.observe({motion(step)}, step * kStep, step >= slow);
    if (!proof.is_complete(step * kStep)) continue;
    if (drift) *drift = proof.drift();
    return step;
  }
  return std::nullopt;
}

/// By trying every start.
std::optional<int> earliest(const Motion& motion, int slow, const PhysicsOptions& options) {
  const int check = steps_in(options.check_time);
  for (int start = slow; start + check <= 4000; ++start) {
    double drift = 0.0;
    for (int step = start; step <= start + check; ++step)
      drift = std::max(drift, (motion(step) - motion(start)).norm());
    if (drift <= options.drift_max) return start + check;
  }
  return std::nullopt;
}

TEST(RestProof, ComesAsSoonAsSomeStartAllows) {
  const PhysicsOptions options;
  const double lag = 0.05 / kStep;  // between starts that are followed
  const std::vector<Motion> motions = {
      [](int) { return Vec3(1, 2, 3); },
      [](int step) { return Vec3(0.01 * std::exp(-step / 150.0), 0, 0); },            // creeps to rest
      [](int step) { return Vec3(step < 700 ? 3e-6 * step : 0.0021, 0, 0); },         // then stops at once
      [](int step) { return Vec3(0, step == 330 || step == 555 ? 0.001 : 0.0, 0); },  // twitches
  };
  for (const Motion& motion : motions) {
    const auto proven = proven_at(motion, 100, options);
    const auto first = earliest(motion, 100, options);
    ASSERT_TRUE(proven && first);
    EXPECT_GE(*proven, *first);
    EXPECT_LE(*proven, *first + lag);
  }
}

TEST(RestProof, NeverComesForWhatCreepsOnAndOn) {
  const PhysicsOptions options;
  const double per_step = 1.01 * options.drift_max / steps_in(options.check_time);
  EXPECT_FALSE(proven_at([&](int step) { return Vec3(per_step * step, 0, 0); }, 1, options));
}

TEST(RestProof, ReportsTheLargestDistanceFromTheStart) {
  const PhysicsOptions options;
  double drift = 0.0;
  const auto there_and_back = [](int step) { return Vec3(0, 0, step == 70 ? 0.0004 : 0.0); };
  EXPECT_EQ(proven_at(there_and_back, 1, options, &drift), 1 + steps_in(options.check_time));
  EXPECT_DOUBLE_EQ(drift, 0.0004);
}

TEST(RestProof, WithoutACheckASlowPileIsAtRest) {
  PhysicsOptions options;
  options.check_time = 0.0;
  EXPECT_EQ(proven_at([](int step) { return Vec3(step, 0, 0); }, 17, options), 17);
}

}  // namespace
}  // namespace tubebin::physics
