#include "tubebin/physics/lift.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "physics/rest_check.hpp"
#include "physics/rest_proof.hpp"
#include "physics/rigid_world.hpp"
#include "tubebin/scene/lift.hpp"
#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::physics {
namespace {

constexpr double kTubeRadius = 0.0125, kTubeMass = 0.1;

/// At rest where it touches: as deep as contacts are left alone.
scene::PlacedTube tube_between(const Vec3& a, const Vec3& b) {
  return {{.radius = kTubeRadius, .mass = kTubeMass, .nodes = {Vec3::Zero(), b - a}, .cylinders = {{0, 1, 0}}},
          make_pose(Quat::Identity(), a)};
}

LiftResult lift(const DropResult& pile, std::size_t tube) {
  return lift_tube(pile, tube, scene::Bin{}, PhysicsOptions{}, LiftOptions{}, 1);
}

LiftResult lift(const std::vector<scene::PlacedTube>& tubes, std::size_t tube) {
  DropResult pile;
  pile.tubes = tubes;
  return lift(pile, tube);
}

TEST(Lift, AFreeTubeWeighsWhatItWeighsAndLeavesTheOthersAlone) {
  const std::vector<scene::PlacedTube> pile = {tube_between({-0.15, -0.1, kTubeRadius}, {0.15, -0.1, kTubeRadius}),
                                               tube_between({-0.15, 0.1, kTubeRadius}, {0.15, 0.1, kTubeRadius})};
  const LiftResult result = lift(pile, 0);
  ASSERT_EQ(result.rest.failure, DropFailure::none) << result.rest.detail;
  EXPECT_NEAR(result.force, kTubeMass * PhysicsOptions{}.gravity, 1e-6);
  EXPECT_TRUE(result.dragged.empty());
  ASSERT_EQ(result.rest.tubes.size(), 1u);
  EXPECT_LT(largest_movement(nodes_in_world({pile[1]}), nodes_in_world(result.rest.tubes)), 0.0005);
  const PhysicsOptions options;
  EXPECT_GE(result.rest.figures.simulated_seconds, options.check_time);
  EXPECT_LT(result.rest.figures.simulated_seconds, options.check_time + options.rest_window) << "it was at rest before";
}

TEST(Lift, WhatLiesAcrossIsDraggedAndWeighsOnIt) {
  const std::vector<scene::PlacedTube> pile = {
      tube_between({-0.15, -0.1, kTubeRadius}, {0.15, -0.1, kTubeRadius}),
      tube_between({-0.15, 0.1, kTubeRadius}, {0.15, 0.1, kTubeRadius}),
      tube_between({0.0, -0.15, 3.0 * kTubeRadius}, {0.0, 0.15, 3.0 * kTubeRadius})};
  const LiftResult result = lift(pile, 0);
  ASSERT_EQ(result.rest.failure, DropFailure::none) << result.rest.detail;
  EXPECT_EQ(result.dragged, std::vector<std::size_t>{1});  // what was tube 2
  const double weight = kTubeMass * PhysicsOptions{}.gravity;
  EXPECT_GT(result.force, 1.3 * weight) << "half of the upper tube lies on it";
  EXPECT_LT(result.force, 2.2 * weight);
  EXPECT_TRUE(lift(pile, 2).dragged.empty()) << "the upper one is free";
}

TEST(Lift, TheOthersKeepTheirOrderAndWhatTheyBear) {
  const std::vector<scene::PlacedTube> pile = {
      tube_between({-0.15, -0.1, kTubeRadius}, {0.15, -0.1, kTubeRadius}),
      tube_between({-0.15, 0.1, kTubeRadius}, {0.15, 0.1, kTubeRadius}),
      tube_between({0.0, -0.15, 3.0 * kTubeRadius}, {0.0, 0.15, 3.0 * kTubeRadius}),
      tube_between({0.2, -0.15, kTubeRadius}, {0.2, 0.15, kTubeRadius})};
  const LiftResult result = lift(pile, 1);
  ASSERT_EQ(result.rest.failure, DropFailure::none) << result.rest.detail;
  ASSERT_EQ(result.rest.tubes.size(), 3u);
  const auto moved = [&](std::size_t before, std::size_t after) {
    return largest_movement(nodes_in_world({pile[before]}), nodes_in_world({result.rest.tubes[after]}));
  };
  EXPECT_LT(moved(0, 0), 0.01) << "one end of the upper tube still lies on it";
  EXPECT_GT(moved(2, 1), kTubeRadius) << "the other end fell to the floor";
  EXPECT_LT(moved(3, 2), 0.0005);
  for (const scene::Contact& contact : result.rest.contacts) EXPECT_LE(contact.label_b, 3u);
}

double fastest(const RigidWorld& world) {
  double speed = 0.0;
  for (std::size_t i = 0; i < world.size(); ++i) speed = std::max(speed, world.speed(i));
  return speed;
}

TEST(Lift, AWorldGoesOnUnderTheForcesThatHeldThePile) {
  Random random(31);
  const scene::Bin bin;
  const DropResult pile = drop_tubes(tube::generate_tubes(12, {}, random), bin, PhysicsOptions{}, 4);
  ASSERT_EQ(pile.failure, DropFailure::none) << pile.detail;
  PhysicsOptions options;
  options.solver_iterations = 1;  // too few to find forces
  RigidWorld held(pile.tubes, bin, options, *pile.forces), loose(pile.tubes, bin, options);
  for (RigidWorld* world : {&held, &loose}) world->step(options.rest_time_step);
  EXPECT_LT(fastest(held), 0.001);
  EXPECT_GT(fastest(loose), 10.0 * fastest(held));
}

/// Where each contact is and what it bears, of the tubes from `first_tube` on.
std::vector<std::pair<Vec3, Vec3>> contacts_from(const RigidWorld& world, std::size_t first_tube) {
  std::vector<std::pair<Vec3, Vec3>> found;
  for (const StepContact& contact : world.forces().contacts)
    if (contact.second >= first_tube) found.emplace_back(contact.touch.position, contact.force);
  return found;
}

TEST(Lift, WhatNothingTouchesSleepsWithItsForcesUntilItIsStruck) {
  const PhysicsOptions options;
  const std::vector<scene::PlacedTube> pile = {
      tube_between({-0.15, -0.1, kTubeRadius}, {0.15, -0.1, kTubeRadius}),
      tube_between({-0.15, 0.1, kTubeRadius}, {0.15, 0.1, kTubeRadius}),
      tube_between({0.0, 0.02, 3.0 * kTubeRadius}, {0.0, 0.17, 3.0 * kTubeRadius})};
  RigidWorld world(pile, scene::Bin{}, options);
  for (int i = 0; i < 5; ++i) world.step(options.time_step);
  const auto bearing = contacts_from(world, 1);
  ASSERT_GE(bearing.size(), 3u);
  const auto pose = [&](std::size_t tube) { return Eigen::Matrix4d(world.pose(tube).matrix()); };
  const Eigen::Matrix4d lower = pose(1), upper = pose(2);

  world.let_sleep_beyond(0);
  for (int i = 0; i < 5; ++i) world.step(options.time_step);
  EXPECT_EQ(pose(1), lower);
  EXPECT_EQ(pose(2), upper);
  EXPECT_EQ(contacts_from(world, 1), bearing);

  world.put(0, tube_between({-0.15, 0.06, 0.06}, {0.15, 0.06, 0.06}).world_from_tube);
  for (int i = 0; i < 40; ++i) world.step(options.time_step);
  EXPECT_NE(pose(2), upper) << "struck";
  EXPECT_NE(pose(1), lower) << "below what was struck";
  EXPECT_GT(world.pose(0).translation().z(), 0.03) << "it lies on what woke";
}

TEST(Lift, APileIsEmptiedOneByOneAndEachRestIsAPile) {
  Random random(31);
  const PhysicsOptions options;
  const scene::Bin bin;
  DropResult pile = drop_tubes(tube::generate_tubes(8, {}, random), bin, options, 9);
  ASSERT_EQ(pile.failure, DropFailure::none) << pile.detail;
  while (pile.tubes.size() > 1) {
    const DropResult before = pile;
    const LiftResult result = lift(before, 0);
    ASSERT_EQ(result.rest.failure, DropFailure::none) << result.rest.detail;
    pile = result.rest;
    ASSERT_EQ(pile.tubes.size(), before.tubes.size() - 1);
    EXPECT_EQ(pile.tubes.front().tube.nodes, before.tubes[1].tube.nodes);
    EXPECT_LE(deepest_penetration(find_contacts(pile.tubes, bin, 0.0)), options.penetration_max);
    EXPECT_FALSE(find_floating(pile.contacts, pile.tubes.size()));
    EXPECT_GT(result.force, 0.99 * before.tubes[0].tube.mass * options.gravity);
    const LiftResult again = lift(before, 0);
    for (std::size_t k = 0; k < pile.tubes.size(); ++k)
      EXPECT_EQ(again.rest.tubes[k].world_from_tube.matrix(), pile.tubes[k].world_from_tube.matrix());
  }
}

}  // namespace
}  // namespace tubebin::physics
