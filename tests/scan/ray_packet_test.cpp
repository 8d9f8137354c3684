#include "scan/ray_packet.hpp"

#include <gtest/gtest.h>

#include "tubebin/core/random.hpp"

namespace tubebin::scan {
namespace {

/// One ray at a time, by the intervals of the solids.
Hit first_by_intervals(const SceneSolids& solids, const Vec3& direction, double depth_min) {
  Hit first;
  const auto offer = [&](const Interval& inside, cloud::Label label) {
    if (inside.empty() || inside.end < depth_min) return;
    if (inside.begin < first.depth || (inside.begin == first.depth && label < first.label))
      first = {inside.begin, label};
  };
  for (const SolidBox& box : solids.bin) offer(box.intersect(direction), 0);
  for (const auto& [solid, label, bore] : solids.cylinders) offer(solid.intersect(direction), label);
  for (const auto& [solid, label, bore] : solids.spheres) offer(solid.intersect(direction), label);
  return first;
}

Vec3 random_point(Random& random, double depth) {
  return {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), depth + random.uniform(-0.5, 0.5)};
}

TEST(RayPacket, EveryLaneTakesWhatItsRayMeetsFirst) {
  Random random(3);
  SceneSolids solids;
  solids.bin.emplace_back(scene::Box(Vec3(-1, -1, 2.5), Vec3(1, 1, 2.6)));
  solids.bin.emplace_back(scene::Box(Vec3(-0.1, -0.1, 1.0), Vec3(0.1, 0.1, 1.2)));
  for (cloud::Label label = 1; label <= 20; ++label) {
    const Vec3 base = random_point(random, 1.5);
    solids.cylinders.push_back({SolidCylinder(base, base + 0.3 * random_point(random, 0.0), 0.03), label});
    solids.spheres.push_back({SolidSphere(base, 0.03), label});
  }
  int tube_hits = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const auto count = static_cast<std::size_t>(1 + trial % kLanes);
    std::vector<Vec3> directions;
    for (std::size_t i = 0; i < count; ++i)
      directions.emplace_back(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), 1.0);
    if (trial % 5 == 0) directions.front() = Vec3(0, 0, 1);  // within the faces' planes of no box, along axes
    RayPacket packet(directions, 0.1);
    packet.offer_bin(solids.bin);
    for (const auto& sphere : solids.spheres) packet.offer(sphere);
    for (const auto& cylinder : solids.cylinders) packet.offer(cylinder);
    for (std::size_t i = 0; i < count; ++i) {
      const Hit expected = first_by_intervals(solids, directions[i], 0.1);
      const Hit hit = packet.first(static_cast<int>(i));
      EXPECT_EQ(hit.depth, expected.depth);
      EXPECT_EQ(hit.label, expected.label);
      tube_hits += expected.label > 0;
    }
  }
  EXPECT_GT(tube_hits, 1000);
}

TEST(RayPacket, LooksThroughPixelsAsTheCameraDoes) {
  scene::Scanner scanner;
  scanner.position = {0.3, -0.2, 1.7};
  scanner.rotation_deg = {12.0, -7.0, 31.0};
  const scene::Camera camera(scanner);
  const RayPacket packet(camera, 701, 333, 0.1);
  for (int lane = 0; lane < kLanes; ++lane)
    EXPECT_EQ(packet.direction(lane), camera.pixel_direction_in_world(701 + lane, 333)) << lane;
}

TEST(RayPacket, GivesThePointsOfTheFirstLanes) {
  const std::vector<Vec3> directions = {{0, 0, 1}, {0.5, 0, 1}, {0.01, 0.02, 1}};
  RayPacket packet(directions, 0.1);
  packet.offer(Labelled<SolidSphere>{SolidSphere({0, 0, 1}, 0.25), 7});
  std::vector<cloud::Point> points(3);
  std::vector<cloud::Label> labels(3, 99);
  const Vec3 origin(1, 2, 3);
  packet.get_first_points(origin, points, labels);
  EXPECT_EQ(points[0], cloud::Point(1, 2, 3.75));
  EXPECT_TRUE(points[1].array().isNaN().all());
  EXPECT_EQ(points[2], cloud::Point((origin + packet.depth(2) * directions[2]).cast<float>()));
  EXPECT_EQ(labels, (std::vector<cloud::Label>{7, 0, 7}));
}

TEST(RayPacket, GivesTheBinsPointsAtOnceAsPacketsDo) {
  scene::Scene scene;
  scene.bin.draft_deg = 5.0;
  scene.scanner.position = {0.1, -0.2, 2.0};
  scene.scanner.rotation_deg = {20.0, 5.0, 30.0};
  scene.scanner.width = 100;
  scene.scanner.height = 60;
  const scene::Camera camera(scene.scanner);
  const std::vector<SolidBox> bin = scene_solids(scene).bin;
  constexpr double kDepthMin = 0.1, kDepthMax = 2.2;  // cuts some of the floor off
  constexpr int kColumn = 3, kCount = 93;             // ends within a block of lanes
  int found = 0, missed = 0;
  for (int row = 0; row < camera.height(); ++row) {
    std::vector<cloud::Point> points(kCount), expected(kCount);
    std::vector<cloud::Label> labels(kCount);
    ASSERT_TRUE(RayPacket::get_bin_points(camera, kColumn, row, bin, kAllBoxes, kDepthMin, kDepthMax, points));
    for (std::size_t begin = 0; begin < kCount; begin += kLanes) {
      const std::size_t count = std::min<std::size_t>(kLanes, kCount - begin);
      RayPacket packet(camera, kColumn + static_cast<int>(begin), row, kDepthMin);
      packet.offer_bin(bin);
      packet.forget_beyond(kDepthMax);
      packet.get_first_points(scene.scanner.position, std::span(expected).subspan(begin, count),
                              std::span(labels).subspan(begin, count));
    }
    for (std::size_t i = 0; i < kCount; ++i) {
      const bool is_found = cloud::is_finite(expected[i]);
      ++(is_found ? found : missed);
      ASSERT_EQ(cloud::is_finite(points[i]), is_found);
      if (is_found) {
        ASSERT_EQ(points[i], expected[i]);
      }
    }
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(missed, 100);
  std::vector<cloud::Point> points(4);
  const std::vector<SolidBox> around = {SolidBox(scene::Box(Vec3(-1, -1, -1), Vec3(1, 1, 1)))};
  EXPECT_FALSE(RayPacket::get_bin_points(camera, 0, 0, around, kAllBoxes, kDepthMin, kDepthMax, points))
      << "rays that begin inside";
}

TEST(RayPacket, MarksLanesThatBeginInsideOrEnterABore) {
  const std::vector<Vec3> directions = {{0, 0, 1}, {0.6, 0, 1}, {0.012, 0, 1}};
  RayPacket inside(directions, 0.1);
  inside.offer(Labelled<SolidCylinder>{SolidCylinder({-0.05, 0, 0.1}, {0.05, 0, 0.1}, 0.05), 1});
  EXPECT_TRUE(inside.is_special(0));
  EXPECT_FALSE(inside.is_special(1));

  RayPacket into_the_end(directions, 0.1);  // an upright tube of outer radius 15 mm and bore 10 mm, 1 m away
  into_the_end.offer(Labelled<SolidCylinder>{SolidCylinder({0, 0, 1}, {0, 0, 1.5}, 0.015), 1, 0.010});
  EXPECT_TRUE(into_the_end.is_special(0));
  EXPECT_FALSE(into_the_end.is_special(2)) << "the ring of the wall";
  EXPECT_DOUBLE_EQ(into_the_end.first(2).depth, 1.0);
}

}  // namespace
}  // namespace tubebin::scan
