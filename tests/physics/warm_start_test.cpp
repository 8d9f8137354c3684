#include "physics/warm_start.hpp"

#include <gtest/gtest.h>

#include "physics/rest_proof.hpp"
#include "physics/rigid_world.hpp"

namespace tubebin::physics {
namespace {

constexpr double kReach = 0.006;

StepContact contact_at(const Vec3& place) {
  StepContact contact{.first = 0, .second = 1, .touch = {place, Vec3::UnitZ(), 0.0}};
  contact.load = {Vec3(1, 0, 4), Vec3(0, 2, 0), Vec3(0, 0, 3)};
  contact.normal_force = contact.normal_force_before = 4.0;
  return contact;
}

TEST(WarmStart, TakesTheShareOfALastingLoadOnce) {
  WarmStart warm_start({contact_at({0.1, 0, 0})});
  StepContact now{.first = 0, .second = 1, .touch = {Vec3(0.101, 0, 0), Vec3::UnitZ(), 0.0}};
  StepContact twin = now;
  const ContactLoad load = warm_start.start(now, 0.5, kReach, true);
  EXPECT_EQ(load.force_on_second, Vec3(0.5, 0, 2));
  EXPECT_EQ(load.torque_on_first, Vec3(0, 1, 0));
  EXPECT_EQ(load.torque_on_second, Vec3(0, 0, 1.5));
  EXPECT_EQ(now.normal_force_before, 4.0);
  EXPECT_EQ(warm_start.start(twin, 0.5, kReach, true).force_on_second, Vec3::Zero());
}

TEST(WarmStart, LeavesTheImpactOfOneStepOut) {
  StepContact hit = contact_at(Vec3::Zero());
  hit.normal_force_before = 1.0;  // four times as much in the last step
  StepContact now{.first = 0, .second = 1, .touch = hit.touch};
  EXPECT_EQ(WarmStart({hit}).start(now, 0.8, kReach, true).force_on_second, 0.8 * 0.25 * hit.load.force_on_second);
  hit.normal_force_before = 0.0;  // new
  EXPECT_EQ(WarmStart({hit}).start(now, 0.8, kReach, true).force_on_second, Vec3::Zero());
}

TEST(WarmStart, StartsFromNothingWhereItIsAnotherContactOrMoves) {
  const StepContact old = contact_at(Vec3::Zero());
  const auto starts = [&](StepContact now, bool resting) {
    return !WarmStart({old}).start(now, 0.8, kReach, resting).force_on_second.isZero();
  };
  EXPECT_TRUE(starts(old, true));
  EXPECT_FALSE(starts(old, false));
  StepContact other = old;
  other.touch.position.x() = 0.007;
  EXPECT_FALSE(starts(other, true));
  other = old;
  other.touch.normal = Vec3::UnitX();
  EXPECT_FALSE(starts(other, true));
  other = old;
  other.first = kBinBody;
  EXPECT_FALSE(starts(other, true));
}

TEST(WarmStart, FindsEachContactAmongThoseOfItsBodies) {
  std::vector<StepContact> before(4, contact_at(Vec3::Zero()));
  before[0].first = kBinBody, before[0].second = 0;
  before[1].first = kBinBody, before[1].second = 1;
  before[2].first = 0, before[2].second = 1;
  before[3].first = kBinBody, before[3].second = 2;
  for (std::size_t i = 0; i < before.size(); ++i)
    before[i].load.force_on_second = Vec3(0, 0, static_cast<double>(i + 1));
  WarmStart warm_start(before);
  for (const std::size_t i : {0u, 2u, 3u}) {  // the second is gone
    StepContact now = before[i];
    EXPECT_EQ(warm_start.start(now, 1.0, kReach, true).force_on_second, before[i].load.force_on_second);
  }
}

scene::PlacedTube lying(double x, double z, bool along_x) {
  const Vec3 end = along_x ? Vec3(0.2, 0, 0) : Vec3(0, 0.2, 0);
  const tube::Tube tube{.radius = 0.0125, .mass = 0.05, .nodes = {-0.5 * end, 0.5 * end}, .cylinders = {{0, 1, 0}}};
  const Vec3 place = along_x ? Vec3(0, x, z) : Vec3(x, 0, z);
  return {tube, make_pose(Quat::Identity(), place)};
}

TEST(WarmStart, ATubeThatFallsDoesNotBounce) {
  const PhysicsOptions options;
  RigidWorld world({lying(0, 0.05, true)}, scene::Bin{}, options, 1);
  double highest = 0.0;
  bool landed = false;
  for (int i = 0; i < 400; ++i) {
    world.step(step_settings(options));
    landed = landed || world.center_of_mass(0).z() < 0.0126;
    if (landed) highest = std::max(highest, world.center_of_mass(0).z());
  }
  EXPECT_TRUE(landed);
  EXPECT_LT(highest, 0.0126);
}

/// How far layers of two tubes, laid crosswise, move in a second: all loads run through all layers below.
double creep_of_a_stack(double warm_start) {
  std::vector<scene::PlacedTube> tubes;
  for (int layer = 0; layer < 6; ++layer)
    for (const double x : {-0.06, 0.06}) tubes.push_back(lying(x, 0.0124 + 0.0249 * layer, layer % 2 == 0));
  PhysicsOptions options;
  options.warm_start = warm_start;
  options.solver_iterations = 20;
  RigidWorld world(tubes, scene::Bin{}, options, 1);
  for (int i = 0; i < 400; ++i) world.step(step_settings(options));
  const std::vector<Vec3> before = nodes_in_world(world.tubes());
  for (int i = 0; i < 200; ++i) world.step(step_settings(options));
  return largest_movement(before, nodes_in_world(world.tubes()));
}

TEST(WarmStart, AStackCreepsLess) {
  const double warm = creep_of_a_stack(0.8);
  EXPECT_LT(warm, 0.4 * creep_of_a_stack(0.0));
  EXPECT_LT(warm, PhysicsOptions{}.drift_max);
}

}  // namespace
}  // namespace tubebin::physics
