#include "scan/packet_bodies.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "scan/random_scene.hpp"
#include "scan/ray_caster.hpp"
#include "scan/view_window.hpp"

namespace tubebin::scan {
namespace {

constexpr double kDepthMin = 0.1;  // metres

scene::Scene scene_in_small_image(int tubes, std::uint64_t seed) {
  scene::Scene scene = testing::random_scene(tubes, seed);
  testing::look_closely(scene.scanner, 240, 150);
  return scene;
}

bool is_met(const auto& solid, const Vec3& direction) {
  const Interval inside = solid.intersect(direction);
  return !inside.empty() && inside.end >= kDepthMin;
}

/// Calls check(bodies, direction) for every pixel of the window.
template <typename Check>
void for_each_pixel(const SceneSolids& solids, const scene::Camera& camera, const Check& check) {
  const scene::PixelWindow window = view_window(solids, SeenBodies::bin_and_tubes, camera, kDepthMin);
  const PacketBodies bodies(solids, camera, window, kDepthMin);
  for (int row = window.y; row < window.y + window.height; ++row)
    for (int column = window.x; column < window.x + window.width; ++column)
      check(bodies.at(column, row), camera.pixel_direction_in_world(column, row));
}

TEST(PacketBodies, NameAllThatARayMeets) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const scene::Scene scene = scene_in_small_image(6, seed);
    const SceneSolids solids = scene_solids(scene);
    int met = 0, missing = 0;
    for_each_pixel(solids, scene::Camera(scene.scanner), [&](const BodiesInReach& bodies, const Vec3& direction) {
      const auto is_named = [&](std::uint32_t solid) {
        const auto end = bodies.solids.begin() + std::min<std::ptrdiff_t>(bodies.solid_count, BodiesInReach::kFew);
        return bodies.solid_count > BodiesInReach::kFew || std::find(bodies.solids.begin(), end, solid) != end;
      };
      std::uint32_t solid = 0;
      const auto expect_named = [&](const auto& labelled) {
        const bool hit = is_met(labelled.solid, direction);
        met += hit;
        missing += hit && !is_named(solid);
        ++solid;
      };
      std::ranges::for_each(solids.cylinders, expect_named);
      std::ranges::for_each(solids.spheres, expect_named);
      for (std::size_t box = 0; box < solids.bin.size(); ++box)
        missing += !solids.bin[box].intersect(direction).empty() && !(bodies.boxes & box_flag(box));
    });
    EXPECT_GT(met, 5000);
    EXPECT_EQ(missing, 0);
  }
}

TEST(PacketBodies, LeaveMostOfAnImageWithoutTubes) {
  const scene::Scene scene = scene_in_small_image(1, 4);
  int pixels = 0, with_tube = 0;
  for_each_pixel(scene_solids(scene), scene::Camera(scene.scanner), [&](const BodiesInReach& bodies, const Vec3&) {
    ++pixels;
    with_tube += bodies.solid_count > 0;
  });
  EXPECT_GT(with_tube, 0);
  EXPECT_LT(with_tube, pixels / 3);
}

TEST(RayCaster, FindsTheSameByTreeAsOneByOneAndRayByRay) {
  const scene::Scene scene = scene_in_small_image(8, 5);
  const scene::Camera camera(scene.scanner);
  const SceneSolids solids = scene_solids(scene);
  const RayCaster caster(solids, kDepthMin, 3.0);
  const scene::PixelWindow window = view_window(solids, SeenBodies::bin_and_tubes, camera, kDepthMin);
  const PacketBodies bodies(solids, camera, window, caster.depth_min());
  BodiesInReach all;
  all.boxes = kAllBoxes;
  all.solid_count = BodiesInReach::kFew + 1;
  int few = 0, tubes = 0;
  for (int row = window.y; row < window.y + window.height; ++row)
    for (int column = window.x; column + kLanes <= window.x + window.width; column += kLanes) {
      RayPacket packet(camera, column, row, caster.depth_min()), by_tree = packet;
      caster.find_first_hits(packet, kLanes, bodies.at(column, row));
      caster.find_first_hits(by_tree, kLanes, all);
      few += bodies.at(column, row).solid_count <= BodiesInReach::kFew;
      for (int lane = 0; lane < kLanes; ++lane) {
        const Hit hit = caster.first_hit(camera.pixel_direction_in_world(column + lane, row));
        tubes += hit.label > 0;
        ASSERT_EQ(packet.first(lane).depth, hit.depth);
        ASSERT_EQ(by_tree.first(lane).depth, hit.depth);
        if (!hit.found()) continue;
        ASSERT_EQ(packet.first(lane).label, hit.label);
        ASSERT_EQ(by_tree.first(lane).label, hit.label);
      }
    }
  EXPECT_GT(few, 1000);
  EXPECT_GT(tubes, 3000);
}

}  // namespace
}  // namespace tubebin::scan
