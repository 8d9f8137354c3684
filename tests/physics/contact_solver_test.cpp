#include "physics/contact_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace tubebin::physics {
namespace {

constexpr double kSolverStep = 0.01;  // seconds
constexpr double kMass = 0.2;         // kg
constexpr double kRadius = 0.05;      // metres

SolverBody falling_ball(const Vec3& center, const Vec3& gravity) {
  const double inertia = 0.4 * kMass * kRadius * kRadius;
  return {.velocity = kSolverStep * gravity,
          .center = center,
          .inverse_mass = 1.0 / kMass,
          .inverse_inertia = Eigen::Matrix3d::Identity() / inertia};
}

StepContact floor_contact(double friction) {
  return {.first = kBinBody, .second = 0, .touch = {Vec3::Zero(), Vec3::UnitZ(), 0.0}, .friction = friction};
}

PhysicsOptions converged() {
  PhysicsOptions options;
  options.solver_iterations = 2000;
  options.solver_tolerance = 1e-12;
  options.contact_cfm = 0.0;
  options.rolling_resistance = 0.0;
  return options;
}

/// A ball on a slope, seen with the slope as the floor.
StepContact ball_on_slope(double slope, double friction, const PhysicsOptions& options) {
  const Vec3 gravity(options.gravity * std::sin(slope), 0, -options.gravity * std::cos(slope));
  std::vector<StepContact> contacts = {floor_contact(friction)};
  solve_contacts(options, kSolverStep, {falling_ball({0, 0, kRadius}, gravity)}, contacts);
  return contacts[0];
}

TEST(ContactSolver, ABallRollsDownASlopeAsTheClosedFormSays) {
  const double slope = radians(30.0);
  const PhysicsOptions options = converged();
  const double weight = kMass * options.gravity;
  // Rolling without sliding takes a friction of (2 / 7) m g sin(slope); less grip slides at the cone's edge.
  const StepContact gripping = ball_on_slope(slope, 1.0, options);
  EXPECT_NEAR(gripping.force.z(), weight * std::cos(slope), 1e-4);
  EXPECT_NEAR(gripping.force.x(), -2.0 / 7.0 * weight * std::sin(slope), 1e-4);
  const StepContact sliding = ball_on_slope(slope, 0.1, options);
  EXPECT_NEAR(sliding.force.x(), -0.1 * weight * std::cos(slope), 1e-4);
}

TEST(ContactSolver, ResistanceToRollingHoldsABallUpToItsLimit) {
  PhysicsOptions options = converged();
  options.rolling_resistance = 0.002;
  const double weight = kMass * options.gravity;
  const double limit = std::atan(options.rolling_resistance / kRadius);
  const StepContact held = ball_on_slope(0.9 * limit, 1.0, options);
  EXPECT_NEAR(held.force.x(), -weight * std::sin(0.9 * limit), 1e-4) << "all that pulls it down is borne";
  const StepContact rolling = ball_on_slope(1.5 * limit, 1.0, options);
  EXPECT_GT(rolling.force.x(), -0.95 * weight * std::sin(1.5 * limit));
  EXPECT_NEAR(rolling.resistance.norm(), options.rolling_resistance * rolling.force.z(), 1e-9);
}

/// Balls upon each other; contact k is under ball k.
struct Tower {
  std::vector<SolverBody> bodies;
  std::vector<StepContact> contacts;

  Tower(int balls, const PhysicsOptions& options) {
    for (int i = 0; i < balls; ++i) {
      const double below = 2.0 * kRadius * i;
      bodies.push_back(falling_ball({0, 0, below + kRadius}, {0, 0, -options.gravity}));
      contacts.push_back(floor_contact(1.0));
      contacts.back().touch.position.z() = below;
      contacts.back().second = static_cast<std::size_t>(i);
      if (i > 0) contacts.back().first = static_cast<std::size_t>(i - 1);
    }
  }
};

TEST(ContactSolver, FewIterationsAStepEndWithEachContactBearingWhatIsAboveIt) {
  PhysicsOptions options = converged();
  options.solver_iterations = 4;
  Tower tower(20, options);
  for (int step = 0; step < 600; ++step) solve_contacts(options, kSolverStep, tower.bodies, tower.contacts);
  for (std::size_t i = 0; i < tower.contacts.size(); ++i)
    EXPECT_NEAR(tower.contacts[i].force.z(), static_cast<double>(20 - i) * kMass * options.gravity, 0.01) << i;
}

TEST(ContactSolver, AGapMayCloseWithinTheStepAndNoFurther) {
  const PhysicsOptions options = converged();
  std::vector<StepContact> contacts = {floor_contact(0.0)};
  contacts[0].touch.depth = -0.003;
  const double speed = 1.0;
  solve_contacts(options, kSolverStep, {falling_ball({0, 0, kRadius}, {0, 0, -speed / kSolverStep})}, contacts);
  EXPECT_NEAR(speed - kSolverStep * contacts[0].force.z() / kMass, 0.003 / kSolverStep, 1e-9);
}

TEST(ContactSolver, AnInterpenetrationIsCorrectedByItsShare) {
  PhysicsOptions options = converged();
  std::vector<StepContact> contacts = {floor_contact(0.0)};
  contacts[0].touch.depth = options.contact_layer + 0.001;
  solve_contacts(options, kSolverStep, {falling_ball({0, 0, kRadius}, {0, 0, -options.gravity})}, contacts);
  const double speed_after = kSolverStep * (contacts[0].force.z() / kMass - options.gravity);
  EXPECT_NEAR(speed_after, options.contact_erp * 0.001 / kSolverStep, 1e-9);
}

}  // namespace
}  // namespace tubebin::physics
