#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <thread>

#include "physics/rest_check.hpp"
#include "physics/rest_proof.hpp"
#include "physics/rigid_world.hpp"
#include "physics/spawn.hpp"
#include "tubebin/physics/drop_simulator.hpp"
#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::physics {
namespace {

tube::Tube straight_tube(double length) {
  return {.radius = 0.0125, .mass = 0.1, .nodes = {Vec3(0, 0, 0), Vec3(length, 0, 0)}, .cylinders = {{0, 1, 0}}};
}

scene::PlacedTube at(const tube::Tube& tube, const Vec3& place) { return {tube, make_pose(Quat::Identity(), place)}; }

double deepest_overlap(const std::vector<scene::PlacedTube>& tubes, const scene::Bin& bin) {
  return deepest_penetration(find_contacts(tubes, bin, 0.0));
}

TEST(RigidWorld, FreeFallFollowsItsLawAtEveryStepSize) {
  for (const double step : {0.001, 0.002, 0.004, 0.008}) {
    PhysicsOptions options;
    options.time_step = step;
    options.damping_linear = options.damping_angular = 0.0;
    options.speed_max = 1000.0;
    RigidWorld world({at(straight_tube(0.3), {0, 0, 5.0})}, scene::Bin{}, options);
    const int steps = static_cast<int>(std::lround(0.4 / step));
    for (int i = 0; i < steps; ++i) world.step(options.time_step);
    const double fallen = 5.0 - world.center_of_mass(0).z();
    // Semi-implicit Euler: g h^2 n (n + 1) / 2, half a step's speed more than the true g t^2 / 2.
    EXPECT_NEAR(fallen, options.gravity * step * step * steps * (steps + 1) / 2.0, 1e-9);
    EXPECT_NEAR(fallen, options.gravity * 0.16 / 2.0, options.gravity * 0.4 * step);
    EXPECT_NEAR(world.speed(0), options.gravity * 0.4, 1e-9);
  }
}

TEST(RigidWorld, ATubeRestsAtItsRadiusAtEveryStepSize) {
  for (const double step : {0.001, 0.002, 0.004}) {
    PhysicsOptions options;
    options.time_step = step;
    RigidWorld world({at(straight_tube(0.3), {-0.15, 0, 0.05})}, scene::Bin{}, options);
    for (int i = 0; i < static_cast<int>(2.0 / step); ++i) world.step(options.time_step);
    EXPECT_LT(world.center_of_mass(0).z(), 0.0125 + 1e-5) << step;
    EXPECT_GT(world.center_of_mass(0).z(), 0.0125 - options.contact_layer - 1e-5) << step;
    EXPECT_LT(world.speed(0), 1e-4);
  }
}

TEST(RigidWorld, AStandingTubeStaysUpright) {
  const tube::Tube tube{
      .radius = 0.0125, .mass = 0.1, .nodes = {Vec3(0, 0, 0), Vec3(0, 0, 0.1)}, .cylinders = {{0, 1, 0}}};
  const PhysicsOptions options;
  RigidWorld world({at(tube, {0, 0, 0.001})}, scene::Bin{}, options);
  for (int i = 0; i < 500; ++i) world.step(options.time_step);
  EXPECT_NEAR(world.center_of_mass(0).z(), 0.05, 3e-4);
  EXPECT_GT((world.pose(0).linear() * Vec3::UnitZ()).z(), 0.9999);
}

TEST(RigidWorld, FrictionDecidesWhetherALeaningTubeSlides) {
  // A ladder against a wall with friction mu at both ends stands when its slope exceeds (1 - mu^2) / (2 mu).
  const auto slides = [](double friction) {
    PhysicsOptions options;
    options.friction_bin = friction;
    scene::Bin bin;
    bin.height = 0.5;
    const double angle = radians(60.0);
    const double length = 0.3;
    const double r = 0.0125;
    const Vec3 direction(std::cos(angle), 0, std::sin(angle));
    // Its top rim touches the wall at +x, its lower rim the floor.
    const Vec3 top(bin.length / 2 - r * std::sin(angle), 0, 0);
    Vec3 base = top - length * direction;
    base.z() = r * std::cos(angle);
    const tube::Tube tube{
        .radius = r, .mass = 0.1, .nodes = {Vec3::Zero(), length * direction}, .cylinders = {{0, 1, 0}}};
    RigidWorld world({at(tube, base)}, bin, options);
    const double start = world.center_of_mass(0).z();
    for (int i = 0; i < 250; ++i) world.step(options.time_step);
    return world.center_of_mass(0).z() < start - 0.01;
  };
  EXPECT_TRUE(slides(0.05));
  EXPECT_FALSE(slides(0.8));
}

TEST(Spawn, IsAboveTheRimBetweenTheWallsAndFreeOfOverlap) {
  Random random(9);
  const scene::Bin bin;
  const PhysicsOptions options;
  const auto tubes = spawn(tube::generate_tubes(20, {}, random), bin, options, random);
  ASSERT_TRUE(tubes);
  for (const scene::PlacedTube& tube : *tubes) {
    const scene::Box bounds = CollisionTube(tube).bounds;
    EXPECT_GE(bounds.min().z(), bin.height);
    EXPECT_GE(bounds.min().x(), -bin.length / 2);
    EXPECT_LE(bounds.max().x(), bin.length / 2);
    EXPECT_GE(bounds.min().y(), -bin.width / 2);
    EXPECT_LE(bounds.max().y(), bin.width / 2);
  }
  EXPECT_TRUE(find_contacts(*tubes, bin, 0.0).empty());
}

TEST(Spawn, GivesUpOnATubeThatFitsInNoOrientation) {
  scene::Bin narrow;
  narrow.length = narrow.width = 0.03;
  const DropResult result = drop_tubes({straight_tube(0.5)}, narrow, PhysicsOptions{}, 1);
  EXPECT_EQ(result.failure, DropFailure::spawn);
}

TEST(Drop, LeavesTubesAtRestTouchingAndHardlyInterpenetrating) {
  Random random(21);
  const scene::Bin bin;
  const PhysicsOptions options;
  const DropResult result = drop_tubes(tube::generate_tubes(6, {}, random), bin, options, 5);
  ASSERT_EQ(result.failure, DropFailure::none) << result.detail;
  ASSERT_EQ(result.tubes.size(), 6u);
  EXPECT_LE(deepest_overlap(result.tubes, bin), options.penetration_max);
  EXPECT_LE(result.figures.largest_drift, options.drift_max);
  EXPECT_FALSE(find_floating(result.contacts, result.tubes.size()));
  const double at_rest = options.check_time * (1.0 / options.time_step - 1.0 / options.rest_time_step);
  EXPECT_LE(result.figures.steps, result.figures.simulated_seconds / options.time_step - at_rest + 1.0)
      << "the proof took steps as short as the fall's";

  // Anew, from the finished poses alone: nothing may move for a second.
  RigidWorld world(result.tubes, bin, options);
  for (int i = 0; i < static_cast<int>(1.0 / options.time_step); ++i) world.step(options.time_step);
  EXPECT_LT(largest_movement(nodes_in_world(result.tubes), nodes_in_world(world.tubes())), 2.0 * options.drift_max);
}

TEST(Drop, LeaningWallsHoldTubes) {
  Random random(24);
  const scene::Bin bin{.draft_deg = 10.0, .rim_width = 0.02, .corner_radius = 0.05};
  const PhysicsOptions options;
  const DropResult result = drop_tubes(tube::generate_tubes(8, {}, random), bin, options, 6);
  ASSERT_EQ(result.failure, DropFailure::none) << result.detail;
  const double lean = std::tan(radians(bin.draft_deg)), slope = std::hypot(1.0, lean);
  double nearest_to_wall = 1.0;
  for (const scene::PlacedTube& tube : result.tubes)
    for (int node = 0; node < static_cast<int>(tube.tube.nodes.size()); ++node) {
      const Vec3 p = tube.node_in_world(node);
      if (p.z() > bin.height) continue;
      const double to_x = (bin.length / 2.0 + lean * p.z() - std::abs(p.x())) / slope;
      const double to_y = (bin.width / 2.0 + lean * p.z() - std::abs(p.y())) / slope;
      nearest_to_wall = std::min({nearest_to_wall, to_x, to_y});
    }
  EXPECT_GT(nearest_to_wall, -options.penetration_max);
  EXPECT_LT(nearest_to_wall, 0.05) << "no tube came near a wall";
}

TEST(Drop, ShortTubesComeToRestToo) {
  Random random(3);
  tube::TubeOptions options;
  options.length = 0.1;
  options.cylinder_count_min = 2;
  options.cylinder_count_max = 3;
  const scene::Bin bin{.length = 2.0, .width = 1.5};
  const DropResult drop = drop_tubes(tube::generate_tubes(20, options, random), bin, PhysicsOptions{}, 1);
  EXPECT_EQ(drop.failure, DropFailure::none) << drop.detail;
}

TEST(Drop, TheSeedDecidesWhateverRanBefore) {
  Random random(22);
  const std::vector<tube::Tube> tubes = tube::generate_tubes(4, {}, random);
  const DropResult first = drop_tubes(tubes, scene::Bin{}, PhysicsOptions{}, 3);
  drop_tubes(tube::generate_tubes(3, {}, random), scene::Bin{}, PhysicsOptions{}, 4);
  const DropResult second = drop_tubes(tubes, scene::Bin{}, PhysicsOptions{}, 3);
  ASSERT_EQ(first.tubes.size(), second.tubes.size());
  for (std::size_t i = 0; i < first.tubes.size(); ++i)
    EXPECT_EQ(first.tubes[i].world_from_tube.matrix(), second.tubes[i].world_from_tube.matrix());
}

TEST(Drop, ThreadsDoNotDisturbEachOther) {
  Random random(23);
  const std::vector<tube::Tube> tubes = tube::generate_tubes(4, {}, random);
  const DropResult alone = drop_tubes(tubes, scene::Bin{}, PhysicsOptions{}, 3);
  std::array<DropResult, 4> together;
  std::vector<std::thread> threads;
  for (DropResult& result : together)
    threads.emplace_back([&] { result = drop_tubes(tubes, scene::Bin{}, PhysicsOptions{}, 3); });
  for (std::thread& thread : threads) thread.join();
  for (const DropResult& result : together) {
    ASSERT_EQ(result.tubes.size(), alone.tubes.size()) << result.detail;
    for (std::size_t i = 0; i < alone.tubes.size(); ++i)
      EXPECT_EQ(result.tubes[i].world_from_tube.matrix(), alone.tubes[i].world_from_tube.matrix());
  }
}

TEST(Drop, ATubeThatFallsBesideTheBinIsReported) {
  scene::Bin low;
  low.height = 0.002;
  low.length = low.width = 0.06;
  PhysicsOptions options;
  options.spill = Spill::reject;
  const DropResult result = drop_tubes({straight_tube(0.5)}, low, options, 2);
  EXPECT_EQ(result.failure, DropFailure::outside);
  EXPECT_EQ(result.detail, "tube 1 left the bin");
}

TEST(Drop, AnOverfullBinLosesTubesUnlessTheyAreGuardedOrDroppedAgain) {
  const auto drop = [](Spill spill) {
    Random random(4);
    PhysicsOptions options;
    options.spill = spill;
    return drop_tubes(tube::generate_tubes(20, {}, random), scene::Bin{}, options, 2);
  };
  EXPECT_EQ(drop(Spill::reject).failure, DropFailure::outside);
  for (const Spill spill : {Spill::guard, Spill::redrop}) {
    const DropResult result = drop(spill);
    EXPECT_EQ(result.failure, DropFailure::none) << result.detail;
    EXPECT_EQ(result.tubes.size(), 20u);
    EXPECT_EQ(result.figures.redropped > 0, spill == Spill::redrop);
  }
}

TEST(Drop, FiftyTubesInALargeBinComeToRest) {
  Random random(8);
  const scene::Bin bin{.length = 1.0, .width = 0.8, .height = 0.6};
  const PhysicsOptions options;
  const DropResult result = drop_tubes(tube::generate_tubes(50, {}, random), bin, options, 3);
  ASSERT_EQ(result.failure, DropFailure::none) << result.detail;
  EXPECT_LE(deepest_overlap(result.tubes, bin), options.penetration_max);
  EXPECT_LE(result.figures.largest_drift, options.drift_max);
  EXPECT_FALSE(find_floating(result.contacts, result.tubes.size()));
}

TEST(Drop, AMovingSceneAtTheTimeLimitIsUnsettled) {
  PhysicsOptions options;
  options.time_limit = 0.2;
  options.check_time = 0.05;
  const DropResult result = drop_tubes({straight_tube(0.3)}, scene::Bin{}, options, 2);
  EXPECT_EQ(result.failure, DropFailure::unsettled);
}

TEST(RestCheck, FindsTheTubeThatNothingHolds) {
  const auto contact = [](std::uint32_t a, std::uint32_t b) {
    return scene::Contact{a, b, Vec3::Zero(), Vec3::UnitZ(), 0.0};
  };
  EXPECT_FALSE(find_floating({contact(0, 1), contact(1, 2), contact(2, 3)}, 3));
  EXPECT_EQ(find_floating({contact(0, 1), contact(2, 3)}, 3), 1u);
  EXPECT_EQ(find_floating({}, 1), 0u);
}

}  // namespace
}  // namespace tubebin::physics
