#include "physics/warm_start.hpp"

#include <gtest/gtest.h>

#include "physics/rest_proof.hpp"
#include "physics/rigid_world.hpp"

namespace tubebin::physics {
namespace {

StepContact contact_at(const Vec3& place) {
  return {.first = 0,
          .second = 1,
          .touch = {place, Vec3::UnitZ(), 0.0},
          .force = Vec3(1, 0, 4),
          .resistance = Vec3(0, 2, 0)};
}

/// The same contact, of which nothing is known yet.
StepContact unsolved(StepContact contact) {
  contact.force = contact.resistance = Vec3::Zero();
  return contact;
}

std::vector<StepContact> started(const std::vector<StepContact>& before, std::vector<StepContact> now) {
  scene::PlacedTube tube;
  tube.tube.radius = 0.012;
  const std::vector<CollisionTube> tubes(3, CollisionTube(tube));
  warm_start(before, 0.5, tubes, now);
  return now;
}

TEST(WarmStart, TakesTheShareOfALastingContactOnce) {
  const StepContact moved = unsolved(contact_at({0.101, 0, 0}));
  const auto now = started({contact_at({0.1, 0, 0})}, {moved, moved});
  EXPECT_EQ(now[0].force, Vec3(0.5, 0, 2));
  EXPECT_EQ(now[0].resistance, Vec3(0, 1, 0));
  EXPECT_TRUE(now[1].force.isZero());
}

TEST(WarmStart, StartsFromNothingWhereItIsAnotherContact) {
  const StepContact old = contact_at(Vec3::Zero());
  const auto starts = [&](const StepContact& now) { return !started({old}, {unsolved(now)})[0].force.isZero(); };
  EXPECT_TRUE(starts(old));
  StepContact other = old;
  other.touch.position.x() = 0.007;
  EXPECT_FALSE(starts(other));
  other = old;
  other.touch.normal = Vec3::UnitX();
  EXPECT_FALSE(starts(other));
  other = old;
  other.first = kBinBody;
  EXPECT_FALSE(starts(other));
}

TEST(WarmStart, FindsEachContactAmongThoseOfItsBodies) {
  std::vector<StepContact> before(4, contact_at(Vec3::Zero()));
  before[0].first = kBinBody, before[0].second = 0;
  before[1].first = kBinBody, before[1].second = 1;
  before[2].first = 0, before[2].second = 1;
  before[3].first = kBinBody, before[3].second = 2;
  for (std::size_t i = 0; i < before.size(); ++i) before[i].force.z() = static_cast<double>(i + 1);
  const auto now = started(before, {unsolved(before[0]), unsolved(before[2]), unsolved(before[3])});
  EXPECT_EQ(now[0].force.z(), 0.5);
  EXPECT_EQ(now[1].force.z(), 1.5);
  EXPECT_EQ(now[2].force.z(), 2.0);
}

scene::PlacedTube lying(double x, double z, bool along_x) {
  const Vec3 end = along_x ? Vec3(0.2, 0, 0) : Vec3(0, 0.2, 0);
  const tube::Tube tube{.radius = 0.0125, .mass = 0.05, .nodes = {-0.5 * end, 0.5 * end}, .cylinders = {{0, 1, 0}}};
  const Vec3 place = along_x ? Vec3(0, x, z) : Vec3(x, 0, z);
  return {tube, make_pose(Quat::Identity(), place)};
}

TEST(WarmStart, ATubeThatFallsDoesNotBounce) {
  const PhysicsOptions options;
  RigidWorld world({lying(0, 0.05, true)}, scene::Bin{}, options);
  double highest = 0.0;
  bool landed = false;
  for (int i = 0; i < 400; ++i) {
    world.step(options.time_step);
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
  options.solver_iterations = 12;
  RigidWorld world(tubes, scene::Bin{}, options);
  for (int i = 0; i < 400; ++i) world.step(options.time_step);
  const std::vector<Vec3> before = nodes_in_world(world.tubes());
  for (int i = 0; i < 200; ++i) world.step(options.time_step);
  return largest_movement(before, nodes_in_world(world.tubes()));
}

TEST(WarmStart, AStackCreepsLess) {
  const double warm = creep_of_a_stack(1.0);
  EXPECT_LT(warm, 0.1 * creep_of_a_stack(0.0));
  EXPECT_LT(warm, 0.1 * PhysicsOptions{}.drift_max);
}

}  // namespace
}  // namespace tubebin::physics
