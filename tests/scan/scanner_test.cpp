#include "tubebin/scan/scanner.hpp"

#include <gtest/gtest.h>

#include "scan/random_scene.hpp"
#include "scan/same_points.hpp"
#include "scan/signed_distance.hpp"
#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::scan {
namespace {

using testing::look_closely;
using testing::random_scene;
using testing::SphereTracer;
using testing::worst_surface_distance;

constexpr double kSurfaceTolerance = 5e-6;  // metres: what a point may be off its surface

/// Every pixel of the whole image has what sphere tracing finds there; returns how many were hits.
int expect_agreement_with_sphere_tracing(scene::Scene scene) {
  scene.scanner.region = scene::ScanRegion::full;
  const cloud::Cloud cloud = scan(scene).cloud;
  const scene::Camera camera(scene.scanner);
  const SphereTracer tracer(scene);
  int hits = 0, wrong_labels = 0, wrong_places = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const int column = static_cast<int>(i % cloud.width), row = static_cast<int>(i / cloud.width);
    const auto traced = tracer.trace(camera.pixel_direction_in_world(column, row));
    hits += traced.found ? 1 : 0;
    if (traced.found != cloud::is_finite(cloud.points[i]) || (traced.found && traced.label != cloud.labels[i]))
      ++wrong_labels;
    else if (traced.found && (cloud.points[i].cast<double>() - traced.point).norm() > 2e-5) ++wrong_places;
  }
  EXPECT_EQ(wrong_labels, 0);
  EXPECT_EQ(wrong_places, 0);
  return hits;
}

TEST(Scanner, AgreesWithSphereTracingInRandomScenes) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    scene::Scene scene = random_scene(8, seed);
    look_closely(scene.scanner, 120, 76);
    EXPECT_GT(expect_agreement_with_sphere_tracing(scene), 4000);
  }
}

TEST(Scanner, AgreesWithSphereTracingWhenTiltedAndTurned) {
  scene::Scene scene = random_scene(8, 4);
  look_closely(scene.scanner, 120, 76);
  scene.scanner.position = {1.0, -0.15, 1.2};
  scene.scanner.rotation_deg = {20.0, 37.0, 20.0};
  EXPECT_GT(expect_agreement_with_sphere_tracing(scene), 1000);
}

TEST(Scanner, AgreesWithSphereTracingInABinWithLeaningWallsAndARim) {
  scene::Scene scene = random_scene(8, 6);
  scene.bin.draft_deg = 7.0;
  scene.bin.rim_width = 0.03;
  scene.bin.corner_radius = 0.05;
  look_closely(scene.scanner, 120, 76);
  EXPECT_GT(expect_agreement_with_sphere_tracing(scene), 4000);
  scene.scanner.position = {1.0, -0.15, 1.2};
  scene.scanner.rotation_deg = {20.0, 37.0, 20.0};
  EXPECT_GT(expect_agreement_with_sphere_tracing(scene), 1000);
}

TEST(Scanner, AgreesWithSphereTracingAmongWhatStandsAround) {
  scene::Scene scene = random_scene(8, 6);
  scene.surroundings = {{.table = {.position = {0.0, 0.0, -0.05}, .size = {1.4, 1.2, 0.03}},
                         .boxes = {{.position = {0.5, 0.1, -0.02}, .yaw_deg = 35.0, .size = {0.2, 0.1, 0.3}}},
                         .cylinders = {{.position = {-0.4, -0.4, -0.02}, .radius = 0.06, .height = 0.5},
                                       {.position = {0.1, -0.35, -0.02}, .radius = 0.04, .height = 0.1}},
                         .bins = {{.position = {0.1, 0.75, 0.0}, .yaw_deg = 100.0}}}};
  for (const double draft_deg : {0.0, 7.0}) {
    scene.bin.draft_deg = draft_deg;
    look_closely(scene.scanner, 120, 90);
    scene.scanner.position = {-0.3, -1.2, 1.2};
    scene.scanner.rotation_deg = {45.0, 0.0, -10.0};
    scene.scanner.horizontal_fov_deg = 70.0;
    EXPECT_GT(expect_agreement_with_sphere_tracing(scene), 3000);
    scene.scanner.position = {0.0, 0.0, 1.6};  // where the bin's window has them in part
    scene.scanner.rotation_deg = Vec3::Zero();
    EXPECT_GT(expect_agreement_with_sphere_tracing(scene), 3000);
  }
}

TEST(Scanner, SeesStandingSolidsWhereClosedFormsHaveThem) {
  scene::Scene scene;
  scene.bin.length = scene.bin.width = 0.01;  // out of the way
  scene.bin.height = 0.001;
  const scene::StandingCylinder cylinder = {.position = {0.3, 0.0, -0.02}, .radius = 0.08, .height = 0.25};
  const scene::StandingBox box = {.position = {-0.3, 0.0, -0.02}, .yaw_deg = 0.0, .size = {0.2, 0.1, 0.15}};
  scene.surroundings = {.table = {.position = {0.0, 0.0, -0.05}, .size = {1.2, 1.0, 0.03}},
                        .boxes = {box},
                        .cylinders = {cylinder},
                        .bins = {}};
  scene.scanner.region = scene::ScanRegion::full;
  scene.scanner.width = 321;
  scene.scanner.height = 241;
  const scene::Camera camera(scene.scanner);
  const cloud::Cloud cloud = scan(scene).cloud;
  int tops = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3 way =
        camera.pixel_direction_in_world(static_cast<int>(i % cloud.width), static_cast<int>(i / cloud.width));
    const auto at_height = [&](double z) -> Vec3 { return scene.scanner.position + (2.0 - z) / -way.z() * way; };
    const Vec3 on_cylinder = at_height(0.23), on_box = at_height(0.13), on_table = at_height(-0.02);
    const Vec3 p = cloud.points[i].cast<double>();
    if ((on_cylinder - cylinder.position).head<2>().norm() < 0.08 - 1e-9) {
      EXPECT_LT((p - on_cylinder).norm(), kSurfaceTolerance);
      ++tops;
    } else if (std::abs(on_box.x() + 0.3) < 0.1 - 1e-9 && std::abs(on_box.y()) < 0.05 - 1e-9) {
      EXPECT_LT((p - on_box).norm(), kSurfaceTolerance);
      ++tops;
    } else if (std::abs(on_table.x()) > 0.6 + 1e-9 || std::abs(on_table.y()) > 0.5 + 1e-9) {
      EXPECT_FALSE(cloud::is_finite(cloud.points[i]));  // beyond the table, and nothing stands so high
    } else if ((on_table - cylinder.position).head<2>().norm() > 0.15 && std::abs(on_table.x() + 0.3) > 0.2) {
      EXPECT_TRUE(cloud::is_finite(cloud.points[i]));
    }
  }
  EXPECT_GT(tops, 500);
}

TEST(Scanner, ShowsALeaningWallWhereItIs) {
  scene::Scene scene;
  scene.bin.draft_deg = 10.0;
  look_closely(scene.scanner, 240, 152);
  const double lean = std::tan(radians(10.0));
  int on_walls = 0;
  for (const cloud::Point& point : scan(scene).cloud.points) {
    const Vec3 p = point.cast<double>();
    if (!cloud::is_finite(point) || p.z() < 0.001 || p.z() > scene.bin.height - 0.004) continue;
    const double beyond_x = std::abs(p.x()) - scene.bin.length / 2.0,
                 beyond_y = std::abs(p.y()) - scene.bin.width / 2.0;
    EXPECT_NEAR(std::max(beyond_x, beyond_y), p.z() * lean, kSurfaceTolerance);
    ++on_walls;
  }
  EXPECT_GT(on_walls, 500);
}

TEST(Scanner, AgreesWithSphereTracingAmongTheTubes) {
  scene::Scene scene = random_scene(12, 5);
  look_closely(scene.scanner, 120, 76);
  scene.scanner.horizontal_fov_deg = 120.0;
  scene.scanner.position = {0.02, 0.01, 0.12};
  scene.scanner.range_min = 0.0;
  scene.scanner.rotation_deg = {70.0, 10.0, 30.0};
  EXPECT_GT(expect_agreement_with_sphere_tracing(scene), 4000);
}

TEST(Scanner, LooksIntoTheOpenEndsOfHollowTubes) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    scene::Scene scene = random_scene(5, seed);
    for (scene::PlacedTube& placed : scene.tubes) placed.tube.wall_thickness = 0.002;
    // A straight pipe that stands up shows the floor through it, one that leans its bore.
    tube::Tube pipe{
        .radius = 0.02, .wall_thickness = 0.003, .mass = 1.0, .nodes = {{0, 0, 0}, {0, 0, 0.1}}, .cylinders = {}};
    pipe.cylinders = {{0, 1, 0}};
    for (const double lean_deg : {0.0, 20.0})
      scene.tubes.push_back(
          {pipe, make_pose(Quat(Eigen::AngleAxisd(radians(lean_deg), Vec3::UnitY())), Vec3(lean_deg / 300, 0, 0.05))});
    look_closely(scene.scanner, 160, 100);
    EXPECT_GT(expect_agreement_with_sphere_tracing(scene), 8000);
  }
}

TEST(Scanner, RadiusVariesAlongTubes) {
  for (const double wall : {0.0, 0.001}) {
    scene::Scene scene = random_scene(6, 14);
    Random random(3);
    for (scene::PlacedTube& placed : scene.tubes) {
      placed.tube.wall_thickness = wall;
      for (tube::Cylinder& cylinder : placed.tube.cylinders) cylinder.radius = random.uniform(0.008, 0.016);
    }
    look_closely(scene.scanner, 120, 76);
    EXPECT_GT(expect_agreement_with_sphere_tracing(scene), 4000);
  }
}

TEST(Scanner, HollowTubesAreOpenOnlyAtTheirEnds) {
  scene::Scene hollow = random_scene(8, 7);
  look_closely(hollow.scanner, 480, 304);
  const scene::Scene solid = hollow;
  for (scene::PlacedTube& placed : hollow.tubes) placed.tube.wall_thickness = 0.001;
  const cloud::Cloud with_bores = scan(hollow).cloud, without = scan(solid).cloud;
  ASSERT_EQ(with_bores.size(), without.size());
  std::size_t deeper = 0;
  for (std::size_t i = 0; i < without.size(); ++i) {
    if (!cloud::is_finite(without.points[i]) || with_bores.points[i] == without.points[i]) continue;
    ++deeper;
    const scene::PlacedTube& tube = hollow.tubes[without.labels[i] - 1];  // only tubes have openings
    const Vec3 at_the_end = without.points[i].cast<double>();
    const double to_an_end =
        std::min((at_the_end - tube.node_in_world(0)).norm(),
                 (at_the_end - tube.node_in_world(static_cast<int>(tube.tube.nodes.size()) - 1)).norm());
    EXPECT_LT(to_an_end, tube.tube.radius - tube.tube.wall_thickness + 1e-6);
    EXPECT_FALSE(with_bores.points[i].z() >= without.points[i].z());  // deeper, or nothing at all
  }
  EXPECT_GT(deeper, 100u);
}

TEST(Scanner, SeesTheInnerSurfaceFromInsideATube) {
  scene::Scene scene = random_scene(3, 6);
  look_closely(scene.scanner, 60, 40);
  scene.scanner.horizontal_fov_deg = 100.0;
  scene.scanner.range_min = 0.0;
  // In the joint of two cylinders: their caps inside the joint's sphere are no surface.
  scene.tubes.resize(1);
  scene.tubes[0].world_from_tube.translation().z() += 1.0;  // clear of the bin
  scene.scanner.position = scene.tubes[0].node_in_world(3);
  const Scan inside = scan(scene);
  EXPECT_LT(worst_surface_distance(scene, inside.cloud), kSurfaceTolerance);
  EXPECT_EQ(inside.tube_pixels[0], 60u * 40u);
}

TEST(Scanner, SeesTheBinsOuterSurfaceFromInsideAWall) {
  scene::Scene scene;
  look_closely(scene.scanner, 60, 40);
  scene.scanner.position = {scene.bin.length / 2 + scene.bin.wall_thickness / 2, 0.0, 0.1};
  scene.scanner.range_min = 0.0;
  const Scan down = scan(scene);  // through the wall and, without a seam, through the floor slab below it
  EXPECT_EQ(down.window, (scene::PixelWindow{0, 0, 60, 40}));
  for (const cloud::Point& point : down.cloud.points) EXPECT_GT(std::abs(point.z()), 1e-6F);
  EXPECT_LT(worst_surface_distance(scene, down.cloud), kSurfaceTolerance);
}

TEST(Scanner, NearPlaneOpensWhatReachesThroughIt) {
  scene::Scene scene = random_scene(8, 9);
  look_closely(scene.scanner, 120, 76);
  scene.scanner.range_min = 1.87;  // 0.13 m above the floor
  EXPECT_GT(expect_agreement_with_sphere_tracing(scene), 2000);
}

TEST(Scanner, RangeIsInclusiveAndAlongTheOpticalAxis) {
  scene::Scene scene;
  scene.scanner.range_max = 2.0;  // the floor, exactly, also in the corners of the image
  const Scan whole = scan(scene);
  std::size_t floor_points = 0;
  for (const cloud::Point& point : whole.cloud.points)
    floor_points += cloud::is_finite(point) && point.z() < 1e-6F ? 1 : 0;
  const double pixels_per_metre = scene::Camera(scene.scanner).focal_length() / 2.0;
  const double expected = 0.55 * 0.37 * pixels_per_metre * pixels_per_metre;
  EXPECT_NEAR(static_cast<double>(floor_points), expected, 0.01 * expected);

  scene.scanner.range_max = 1.9999;
  for (const cloud::Point& point : scan(scene).cloud.points) {
    ASSERT_TRUE(!cloud::is_finite(point) || point.z() > 1e-5F);
  }
}

TEST(Scanner, FloorAtTheRangesEndSurvivesEveryTurnAboutTheAxis) {
  scene::Scene scene;
  look_closely(scene.scanner, 60, 40);
  scene.scanner.range_max = 2.0;
  for (int angle = 0; angle < 360; angle += 7) {
    scene.scanner.rotation_deg = {0.0, 0.0, static_cast<double>(angle)};
    const cloud::Cloud cloud = scan(scene).cloud;
    const std::size_t middle = cloud.size() / 2 + cloud.width / 2;
    EXPECT_TRUE(cloud::is_finite(cloud.points[middle])) << angle << " degrees";
  }
}

TEST(Scanner, EveryPointLiesOnItsSurfaceAndItsPixelsRay) {
  const scene::Scene scene = random_scene(10, 11);
  const Scan result = scan(scene);
  EXPECT_LT(worst_surface_distance(scene, result.cloud), kSurfaceTolerance);
  const scene::Camera camera(scene.scanner);
  for (std::size_t i = 0; i < result.cloud.size(); ++i) {
    if (!cloud::is_finite(result.cloud.points[i])) continue;
    const Eigen::Vector2d pixel = camera.project_from_world(result.cloud.points[i].cast<double>());
    ASSERT_NEAR(pixel.x(), result.window.x + static_cast<int>(i % result.cloud.width) + 0.5, 2e-3);
    ASSERT_NEAR(pixel.y(), result.window.y + static_cast<int>(i / result.cloud.width) + 0.5, 2e-3);
  }
}

TEST(Scanner, HasOneColourALabel) {
  const scene::Scene scene = random_scene(10, 14);
  const Scan result = scan(scene);
  const std::vector<cloud::Color> colors = cloud::label_colors(10);
  std::vector<std::size_t> counts(11, 0);
  for (std::size_t i = 0; i < result.cloud.size(); ++i) {
    if (!cloud::is_finite(result.cloud.points[i])) {
      ASSERT_EQ(result.cloud.colors[i], cloud::kNullColor);
      ASSERT_EQ(result.cloud.labels[i], 0u);
      continue;
    }
    ASSERT_LE(result.cloud.labels[i], 10u);
    ASSERT_EQ(result.cloud.colors[i], colors[result.cloud.labels[i]]);
    ++counts[result.cloud.labels[i]];
  }
  for (std::size_t k = 1; k <= 10; ++k) EXPECT_EQ(counts[k], result.tube_pixels[k - 1]);
}

TEST(Scanner, ImagesOfManySizes) {
  scene::Scene scene = random_scene(5, 15);
  for (const auto& [width, height] : {std::pair{1, 1}, {64, 40}, {4096, 3000}}) {
    scene.scanner.width = width;
    scene.scanner.height = height;
    scene.scanner.region = scene::ScanRegion::full;
    const Scan result = scan(scene);
    ASSERT_EQ(result.cloud.size(), static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    EXPECT_EQ(result.cloud.width, static_cast<std::uint32_t>(width));
    if (width <= 64) {
      EXPECT_LT(worst_surface_distance(scene, result.cloud), kSurfaceTolerance);
    }
  }
  // The larger image samples the same surfaces, 4096 x 4096 / 64 x 64 times as densely.
  scene.scanner.width = 4096;
  scene.scanner.height = 3000;
  const double large = static_cast<double>(scan(scene).tube_pixels[0]);
  scene.scanner.width = 512;
  scene.scanner.height = 375;
  EXPECT_NEAR(static_cast<double>(scan(scene).tube_pixels[0]), large / 64.0, 0.03 * large / 64.0);
}

TEST(Scanner, LooksAwayFromEverything) {
  scene::Scene scene = random_scene(3, 16);
  scene.scanner.rotation_deg = {180.0, 0.0, 0.0};
  const Scan away = scan(scene);
  EXPECT_EQ(away.window, scene::PixelWindow{});
  EXPECT_EQ(away.cloud.size(), 0u);
  EXPECT_EQ(away.tube_pixels, std::vector<std::size_t>(3, 0));
}

TEST(Scanner, BranchingTubesRingsAndLoneNodes) {
  scene::Scene scene;
  look_closely(scene.scanner, 120, 76);
  tube::Tube tube;
  tube.radius = 0.0125;
  tube.nodes = {{0, 0, 0.1}, {0.1, 0, 0.1}, {-0.07, 0.07, 0.12}, {-0.07, -0.07, 0.08}, {0.15, 0.1, 0.05}};
  tube.cylinders = {{0, 1, 0}, {0, 2, 0}, {0, 3, 0}};
  scene.tubes.push_back({tube, Pose::Identity()});
  tube::Tube ring = tube;
  ring.nodes = {{-0.2, 0.1, 0.1}, {-0.1, 0.12, 0.1}, {-0.15, 0.17, 0.15}};
  ring.cylinders = {{0, 1, 0}, {1, 2, 1}, {2, 0, 2}};
  scene.tubes.push_back({ring, Pose::Identity()});
  expect_agreement_with_sphere_tracing(scene);
  for (const std::size_t pixels : scan(scene).tube_pixels) EXPECT_GT(pixels, 50u);
}

TEST(Scanner, SameSceneSameBytes) {
  const scene::Scene scene = random_scene(10, 17);
  const Scan first = scan(scene), second = scan(scene);
  EXPECT_TRUE(testing::same_points(first.cloud, second.cloud));
  EXPECT_EQ(first.cloud.labels, second.cloud.labels);
}

}  // namespace
}  // namespace tubebin::scan
