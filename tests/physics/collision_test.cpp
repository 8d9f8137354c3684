#include "physics/collision.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::physics {
namespace {

/// Signed distance to a solid cylinder with flat ends (exact outside and inside).
double distance_to_cylinder(const Vec3& a, const Vec3& b, double radius, const Vec3& p) {
  const Vec3 axis = (b - a).normalized();
  const double half = 0.5 * (b - a).norm();
  const Vec3 offset = p - 0.5 * (a + b);
  const double along = std::abs(offset.dot(axis)) - half;
  const double across = (offset - offset.dot(axis) * axis).norm() - radius;
  return std::min(std::max(along, across), 0.0) + std::hypot(std::max(along, 0.0), std::max(across, 0.0));
}

double distance_to_tube(const scene::PlacedTube& tube, const Vec3& p) {
  double nearest = 1e9;
  const std::vector<int> degrees = tube.tube.node_degrees();
  for (const tube::Cylinder& c : tube.tube.cylinders)
    nearest = std::min(
        nearest, distance_to_cylinder(tube.node_in_world(c.node_a), tube.node_in_world(c.node_b), tube.tube.radius, p));
  for (int i = 0; i < static_cast<int>(degrees.size()); ++i)
    if (degrees[static_cast<std::size_t>(i)] >= 2)
      nearest = std::min(nearest, (p - tube.node_in_world(i)).norm() - tube.tube.radius);
  return nearest;
}

double distance_to_bin(const scene::Bin& bin, const Vec3& p) {
  double nearest = 1e9;
  for (const scene::BinPart& part : scene::bin_parts(bin))
    nearest = std::min(nearest, part.box.exteriorDistance(part.world_from_part.inverse() * p));
  return nearest;
}

std::vector<CollisionBox> boxes_of(const scene::Bin& bin) {
  const std::vector<scene::BinPart> parts = scene::bin_parts(bin);
  return {parts.begin(), parts.end()};
}

/// Points all over a tube's cylinders and caps, `spacing` apart.
std::vector<Vec3> surface_points(const scene::PlacedTube& tube, double spacing) {
  std::vector<Vec3> points;
  const double r = tube.tube.radius;
  for (const tube::Cylinder& c : tube.tube.cylinders) {
    const Vec3 a = tube.node_in_world(c.node_a);
    const Vec3 b = tube.node_in_world(c.node_b);
    const Vec3 axis = (b - a).normalized();
    const Vec3 u = axis.unitOrthogonal();
    const Vec3 v = axis.cross(u);
    const int around = static_cast<int>(std::ceil(2 * std::numbers::pi * r / spacing));
    const int along = static_cast<int>(std::ceil((b - a).norm() / spacing));
    const int rings = static_cast<int>(std::ceil(r / spacing));
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      const Vec3 radial = std::cos(angle) * u + std::sin(angle) * v;
      for (int k = 0; k <= along; ++k) points.push_back(a + (b - a) * k / along + r * radial);
      for (int k = 0; k < rings; ++k)
        for (const Vec3& end : {a, b}) points.push_back(end + r * k / rings * radial);
    }
  }
  return points;
}

scene::PlacedTube straight(const Vec3& a, const Vec3& b, double radius = 0.0125) {
  return {tube::Tube{.radius = radius, .mass = 0.1, .nodes = {a, b}, .cylinders = {{0, 1, 0}}}, Pose::Identity()};
}

std::vector<Touch> touches_of(const scene::PlacedTube& a, const scene::PlacedTube& b, double depth_min = 0.0) {
  std::vector<Touch> touches;
  collide(CollisionTube(a), CollisionTube(b), depth_min, touches);
  return touches;
}

TEST(Collision, CrossingCylindersTouchOnce) {
  const auto touches = touches_of(straight({-0.1, 0, 0}, {0.1, 0, 0}), straight({0, -0.1, 0.0249}, {0, 0.1, 0.0249}));
  ASSERT_EQ(touches.size(), 1u);
  EXPECT_NEAR(touches[0].depth, 0.0001, 1e-12);
  EXPECT_NEAR((touches[0].normal - Vec3::UnitZ()).norm(), 0.0, 1e-12);
  EXPECT_NEAR((touches[0].position - Vec3(0, 0, 0.01245)).norm(), 0.0, 1e-12);
}

TEST(Collision, ParallelCylindersTouchAtBothEndsOfTheirOverlap) {
  const auto touches = touches_of(straight({0, 0, 0}, {0.2, 0, 0}), straight({0.1, 0, 0.0249}, {0.3, 0, 0.0249}));
  ASSERT_GE(touches.size(), 2u);
  double low = 1.0;
  double high = 0.0;
  for (const Touch& touch : touches) {
    low = std::min(low, touch.position.x());
    high = std::max(high, touch.position.x());
  }
  EXPECT_NEAR(low, 0.1, 1e-9);
  EXPECT_NEAR(high, 0.2, 1e-9);
}

TEST(Collision, ABallTouchesSidesEndsAndBalls) {
  const auto ball = [](const Vec3& center) {
    return scene::PlacedTube{tube::Tube{.radius = 0.02, .mass = 0.1, .nodes = {center}, .cylinders = {}},
                             Pose::Identity()};
  };
  const scene::PlacedTube along_x = straight({0, 0, 0}, {0.2, 0, 0});
  const auto expect_touch = [](const std::vector<Touch>& touches, const Vec3& normal) {
    ASSERT_EQ(touches.size(), 1u);
    EXPECT_NEAR(touches[0].depth, 0.0001, 1e-9);
    EXPECT_NEAR((touches[0].normal - normal).norm(), 0.0, 1e-6);
  };
  expect_touch(touches_of(along_x, ball({0.07, 0, 0.0324})), Vec3::UnitZ());
  expect_touch(touches_of(ball({0.07, 0, 0.0324}), along_x), -Vec3::UnitZ());
  expect_touch(touches_of(along_x, ball({0.2199, 0.005, 0})), Vec3::UnitX());
  expect_touch(touches_of(ball({0, 0, 0}), ball({0, 0.0399, 0})), Vec3::UnitY());
  EXPECT_TRUE(touches_of(along_x, ball({0.07, 0, 0.0326})).empty());
  EXPECT_TRUE(touches_of(along_x, ball({0.2201, 0, 0})).empty());
  EXPECT_TRUE(touches_of(ball({0, 0, 0}), ball({0, 0.0401, 0})).empty());
}

TEST(Collision, AFlatEndEndsWhereTheScannerSeesIt) {
  // A capsule would reach a radius beyond the end.
  EXPECT_TRUE(touches_of(straight({0, 0, 0}, {0.2, 0, 0}), straight({0.2126, -0.1, 0}, {0.2126, 0.1, 0}), 0.0).empty());
  const auto touches = touches_of(straight({0, 0, 0}, {0.2, 0, 0}), straight({0.2124, -0.1, 0}, {0.2124, 0.1, 0}));
  ASSERT_EQ(touches.size(), 1u);
  EXPECT_NEAR(touches[0].depth, 0.0001, 1e-9);
  EXPECT_NEAR((touches[0].normal - Vec3::UnitX()).norm(), 0.0, 1e-6);
}

TEST(Collision, FacingEndsTouchFaceToFace) {
  const auto touches = touches_of(straight({0, 0, 0}, {0.1, 0, 0}), straight({0.0999, 0, 0.002}, {0.2, 0, 0.002}));
  ASSERT_EQ(touches.size(), 1u);
  EXPECT_NEAR(touches[0].depth, 0.0001, 1e-8);
  EXPECT_NEAR(std::abs(touches[0].normal.x()), 1.0, 1e-6);
}

TEST(Collision, GapsOfBentTubesMatchTheirSampledSurfaces) {
  // Oracle: dense points of one surface against the exact distance function of the other, both ways.
  Random random(3);
  tube::TubeOptions options;
  options.length = 0.12;
  options.cylinder_count_min = 1;
  options.cylinder_count_max = 4;
  constexpr double kSpacing = 0.0008;
  int compared = 0;
  for (int trial = 0; trial < 4000 && compared < 40; ++trial) {
    const std::vector<tube::Tube> tubes = tube::generate_tubes(2, options, random);
    const scene::PlacedTube a{tubes[0], Pose::Identity()};
    const Vec3 offset(random.uniform(-0.08, 0.08), random.uniform(-0.08, 0.08), random.uniform(-0.08, 0.08));
    const scene::PlacedTube b{tubes[1], make_pose(random.rotation(), offset)};
    const auto touches = touches_of(a, b, -0.02);
    if (touches.empty()) continue;
    double depth = -1.0;
    for (const Touch& touch : touches) depth = std::max(depth, touch.depth);
    if (depth > -0.0005) continue;  // separated pairs have one distance; interpenetrating ones many depths
    ++compared;
    double gap = 1.0;
    for (const Vec3& p : surface_points(a, kSpacing)) gap = std::min(gap, distance_to_tube(b, p));
    for (const Vec3& p : surface_points(b, kSpacing)) gap = std::min(gap, distance_to_tube(a, p));
    // Joint spheres aren't sampled, points lie up to half a spacing beside the nearest, and two rounded rims hide
    // up to twice 0.41 mm.
    EXPECT_LT(-depth, gap + 0.00083) << "trial " << trial;
    EXPECT_GT(-depth, gap - 0.0007) << "trial " << trial;
  }
  EXPECT_EQ(compared, 40);
}

void expect_gaps_of_the_sampled_surface(const scene::Bin& bin) {
  Random random(4);
  tube::TubeOptions options;
  options.length = 0.15;
  options.cylinder_count_min = 1;
  options.cylinder_count_max = 3;
  int compared = 0;
  for (int trial = 0; trial < 4000 && compared < 40; ++trial) {
    const Vec3 place(random.uniform(-0.3, 0.3), random.uniform(-0.2, 0.2), random.uniform(0.0, 0.3));
    const scene::PlacedTube tube{tube::generate_tubes(1, options, random).front(), make_pose(random.rotation(), place)};
    std::vector<Touch> touches;
    collide(boxes_of(bin), CollisionTube(tube), -0.01, touches);
    if (touches.empty()) continue;
    double depth = -1.0;
    for (const Touch& touch : touches) depth = std::max(depth, touch.depth);
    if (depth > -0.0005) continue;
    ++compared;
    double gap = 1.0;
    for (const Vec3& p : surface_points(tube, 0.0008)) gap = std::min(gap, distance_to_bin(bin, p));
    EXPECT_LT(-depth, gap + 0.00083) << "trial " << trial;
    EXPECT_GT(-depth, gap - 0.0007) << "trial " << trial;
  }
  EXPECT_EQ(compared, 40);
}

TEST(Collision, GapsToTheBinMatchTheSampledSurface) {
  expect_gaps_of_the_sampled_surface({});
  expect_gaps_of_the_sampled_surface({.draft_deg = 8.0, .rim_width = 0.03, .corner_radius = 0.05});
}

/// How far two straight tubes overlap, negative for a gap: the least over all directions, found by search. By duality
/// the least way that parts two convex solids, or what keeps them apart, with their support functions in closed form.
double overlap_of_straight(const scene::PlacedTube& first, const scene::PlacedTube& second) {
  const auto reach = [](const scene::PlacedTube& tube, const Vec3& direction) {
    const Vec3 a = tube.node_in_world(0), b = tube.node_in_world(1);
    const double along = (b - a).normalized().dot(direction);
    return std::max(a.dot(direction), b.dot(direction)) +
           tube.tube.radius * std::sqrt(std::max(0.0, 1.0 - along * along));
  };
  const auto overlap = [&](const Vec3& n) { return reach(first, n) + reach(second, -n); };
  Random random(1);
  Vec3 best = Vec3::UnitX();
  for (int i = 0; i < 3000; ++i) {
    const Vec3 n = random.rotation() * Vec3::UnitX();
    if (overlap(n) < overlap(best)) best = n;
  }
  for (double step = 0.05; step > 1e-6; step *= 0.97) {
    const Vec3 n = (best + step * (random.rotation() * Vec3::UnitX())).normalized();
    if (overlap(n) < overlap(best)) best = n;
  }
  return overlap(best);
}

TEST(Collision, EndsThatLieNearlySideBySideTouchAsDeeplyAsTheyOverlap) {
  Random random(7);
  int overlapping = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Vec3 tilt(0.0, random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4));
    const Vec3 end(random.uniform(-0.01, 0.01), random.uniform(0.01, 0.025), random.uniform(-0.01, 0.01));
    const scene::PlacedTube a = straight({0, 0, 0}, {0.3, 0, 0});
    const scene::PlacedTube b = straight(end, end + 0.2 * (Vec3::UnitX() + tilt).normalized());
    const double overlap = overlap_of_straight(a, b);
    if (overlap < 0.0 || overlap > 0.0125) continue;
    ++overlapping;
    const auto touches = touches_of(a, b);
    double deepest = 0.0;
    for (const Touch& touch : touches) deepest = std::max(deepest, touch.depth);
    // Two rounded rims hide up to twice 0.41 mm.
    EXPECT_GT(deepest, overlap - 0.00083) << "trial " << trial << ", " << overlap;
    EXPECT_LT(deepest, 1.2 * overlap) << "trial " << trial << ", " << overlap;
  }
  EXPECT_GT(overlapping, 100);
}

TEST(Collision, AWallsEdgeThatCutsIntoARimTouchesIt) {
  // An end that hangs over the wall's top, tilted by all angles: the edge meets the rim anywhere, at last the side.
  const scene::Bin bin{.length = 0.55, .width = 0.37, .height = 0.20};
  for (double tilt = -0.5; tilt <= 0.5; tilt += 0.05) {
    const Vec3 end(0.228, -0.1768, 0.1991);
    const Vec3 direction = Vec3(0.917, -0.368, std::sin(tilt)).normalized();
    const scene::PlacedTube tube{
        {.radius = 0.0125, .mass = 0.1, .nodes = {Vec3::Zero(), 0.1 * direction}, .cylinders = {{0, 1, 0}}},
        make_pose(Quat::Identity(), end - 0.1 * direction)};
    double sampled = 0.0;
    for (const Vec3& p : surface_points(tube, 0.0002))
      for (const auto& [box, pose, is_turned] : scene::bin_parts(bin))
        if (box.contains(p))
          sampled = std::max(sampled, std::min((p - box.min()).minCoeff(), (box.max() - p).minCoeff()));
    ASSERT_GT(sampled, 0.001);
    std::vector<Touch> touches;
    collide(collision_boxes(bin), CollisionTube(tube), 0.0, touches);
    double deepest = 0.0;
    for (const Touch& touch : touches) deepest = std::max(deepest, touch.depth);
    // A side's touch counts its depth from the edge, not from a face, which makes it less.
    EXPECT_GT(deepest, 0.6 * sampled) << "tilt " << tilt;
  }
}

TEST(Collision, AnEndThatSinksIntoTheWallAtTheFloorIsPushedUpAndInside) {
  const scene::Bin bin;
  const double height = 0.0125 - 0.001;  // its lowest rim point is below the floor and within the wall
  const scene::PlacedTube tube = straight({0, 0, height}, {0, 0.5 * bin.width + 0.003, height});
  std::vector<Touch> touches;
  collide(collision_boxes(bin), CollisionTube(tube), 0.0, touches);
  ASSERT_FALSE(touches.empty());
  for (const Touch& touch : touches) {
    EXPECT_GT(touch.normal.z(), -1e-9);
    EXPECT_LT(touch.normal.y(), 1e-9);
  }
}

TEST(Collision, ATubeOnTheWallsRimIsHeldByItsEdge) {
  const scene::Bin bin;
  const double top = bin.height + 0.0125 - 0.0001;
  const scene::PlacedTube tube = straight({bin.length / 2 - 0.2, 0, top}, {bin.length / 2 + 0.2, 0, top});
  std::vector<Touch> touches;
  collide(collision_boxes(bin), CollisionTube(tube), 0.0, touches);
  ASSERT_FALSE(touches.empty());
  for (const Touch& touch : touches) {
    EXPECT_NEAR(touch.depth, 0.0001, 1e-9);
    EXPECT_NEAR(touch.normal.z(), 1.0, 1e-9);
  }
}

}  // namespace
}  // namespace tubebin::physics
