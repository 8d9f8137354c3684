#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::tube {
namespace {

Tube chain(std::vector<Vec3> nodes, double radius, double wall) {
  Tube tube{.radius = radius, .wall_thickness = wall, .mass = 0.055, .nodes = std::move(nodes), .cylinders = {}};
  for (int i = 0; i + 1 < static_cast<int>(tube.nodes.size()); ++i) tube.cylinders.push_back({i, i + 1, i});
  return tube;
}

/// Inside the union of flat-ended cylinders and joint spheres, by its definition.
bool inside(const Tube& tube, double wall, const Vec3& point) {
  const std::vector<double> radii = tube.node_radii();
  const std::vector<int> degrees = tube.node_degrees();
  for (std::size_t i = 0; i < tube.nodes.size(); ++i)
    if (degrees[i] >= 2 && (point - tube.nodes[i]).norm() <= radii[i] - wall) return true;
  for (const Cylinder& c : tube.cylinders) {
    const Vec3 a = tube.nodes[static_cast<std::size_t>(c.node_a)];
    const Vec3 axis = tube.nodes[static_cast<std::size_t>(c.node_b)] - a;
    const double t = (point - a).dot(axis) / axis.squaredNorm();
    if (t >= 0.0 && t <= 1.0 && (point - a - t * axis).norm() <= tube.radius_of(c) - wall) return true;
  }
  return false;
}

MassProperties monte_carlo(const Tube& tube, int samples) {
  Eigen::AlignedBox3d bounds;
  for (const Vec3& node : tube.nodes) bounds.extend(node);
  bounds = Eigen::AlignedBox3d(bounds.min() - Vec3::Constant(tube.radius_max()),
                               bounds.max() + Vec3::Constant(tube.radius_max()));
  Random random(11);
  std::vector<Vec3> hits;
  for (int i = 0; i < samples; ++i) {
    const Vec3 p(random.uniform(bounds.min().x(), bounds.max().x()), random.uniform(bounds.min().y(), bounds.max().y()),
                 random.uniform(bounds.min().z(), bounds.max().z()));
    if (inside(tube, 0.0, p) && !(tube.wall_thickness > 0.0 && inside(tube, tube.wall_thickness, p))) hits.push_back(p);
  }
  MassProperties properties;
  for (const Vec3& p : hits) properties.center += p / static_cast<double>(hits.size());
  for (const Vec3& p : hits) {
    const Vec3 d = p - properties.center;
    properties.inertia += tube.mass / static_cast<double>(hits.size()) *
                          (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  }
  return properties;
}

TEST(MassProperties, StraightSolidCylinderMatchesTheTextbook) {
  const Tube tube = chain({Vec3(0, 0, 0), Vec3(0, 0, 0.5)}, 0.0125, 0.0);
  const MassProperties m = mass_properties(tube);
  const double across = 0.055 * (3 * 0.0125 * 0.0125 + 0.5 * 0.5) / 12.0;
  EXPECT_NEAR(m.inertia(0, 0), across, 1e-9 * across);
  EXPECT_NEAR(m.inertia(2, 2), 0.055 * 0.0125 * 0.0125 / 2.0, 1e-15);
  EXPECT_NEAR((m.center - Vec3(0, 0, 0.25)).norm(), 0.0, 1e-12);
}

TEST(MassProperties, StraightHollowCylinderMatchesTheTextbook) {
  const Tube tube = chain({Vec3(0, 0, 0), Vec3(0.2, 0, 0), Vec3(0.5, 0, 0)}, 0.0125, 0.002);
  const MassProperties m = mass_properties(tube);
  const double squares = 0.0125 * 0.0125 + 0.0105 * 0.0105;
  EXPECT_NEAR(m.inertia(0, 0), 0.055 * squares / 2.0, 1e-9);
  EXPECT_NEAR(m.inertia(1, 1), 0.055 * (3 * squares + 0.25) / 12.0, 1e-8);
}

TEST(MassProperties, BentTubesMatchMonteCarlo) {
  for (const double wall : {0.0, 0.004}) {
    const Tube tube = chain({Vec3(0, 0, 0), Vec3(0.06, 0, 0), Vec3(0.1, 0.04, 0), Vec3(0.1, 0.06, 0.07)}, 0.0125, wall);
    const MassProperties exact = mass_properties(tube);
    const MassProperties sampled = monte_carlo(tube, 2000000);
    EXPECT_LT((exact.center - sampled.center).norm(), 4e-4);
    EXPECT_LT((exact.inertia - sampled.inertia).norm(), 0.02 * exact.inertia.norm());
  }
}

TEST(MassProperties, RadiusThatVariesMatchesMonteCarlo) {
  TubeOptions options;
  read_yaml_text("shape: curve\nradius_variation: 0.5\n", "test", [&](Fields& fields) { describe(fields, options); });
  Random random(12);
  for (const double wall : {0.0, 0.003}) {
    options.wall_thickness = wall;
    const Tube tube = generate_tubes(1, options, random).front();
    const MassProperties exact = mass_properties(tube);
    const MassProperties sampled = monte_carlo(tube, 300000);
    EXPECT_LT((exact.center - sampled.center).norm(), 2e-3);
    EXPECT_LT((exact.inertia - sampled.inertia).norm(), 0.04 * exact.inertia.norm());
  }
}

TEST(MassProperties, ConeMatchesTheTextbook) {
  // A cone of height h and radius R in 400 steps: centre at h / 4 above its base, inertia about its axis 3/10 m R^2.
  constexpr int kSteps = 400;
  const double height = 0.3, radius = 0.03;
  Tube tube{.radius = radius, .mass = 2.0, .nodes = {Vec3::Zero()}, .cylinders = {}};
  for (int i = 0; i < kSteps; ++i) {
    tube.nodes.emplace_back(0, 0, height * (i + 1) / kSteps);
    tube.cylinders.push_back({i, i + 1, i, radius * (1.0 - (i + 0.5) / kSteps)});
  }
  const MassProperties m = mass_properties(tube);
  EXPECT_NEAR(m.center.z(), height / 4.0, 0.003 * height);
  EXPECT_NEAR(m.inertia(2, 2), 0.3 * 2.0 * radius * radius, 0.01 * 0.3 * 2.0 * radius * radius);
}

TEST(MassProperties, TurnsWithTheTube) {
  Random random(5);
  const Tube tube = generate_tubes(1, {}, random).front();
  const Quat q = random.rotation();
  Tube turned = tube;
  for (Vec3& node : turned.nodes) node = q * node + Vec3(1, 2, 3);
  const MassProperties a = mass_properties(tube);
  const MassProperties b = mass_properties(turned);
  const Eigen::Matrix3d expected = q.toRotationMatrix() * a.inertia * q.toRotationMatrix().transpose();
  EXPECT_LT((b.inertia - expected).norm(), 1e-5 * a.inertia.norm());
  EXPECT_LT((b.center - (q * a.center + Vec3(1, 2, 3))).norm(), 1e-6);
}

TEST(MassProperties, InertiaOfGeneratedTubesIsPositiveDefinite) {
  Random random(6);
  TubeOptions options;
  options.bend_angle_max_deg = 120.0;
  for (const Tube& tube : generate_tubes(200, options, random))
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(mass_properties(tube).inertia).eigenvalues().minCoeff(),
              0);
}

}  // namespace
}  // namespace tubebin::tube
