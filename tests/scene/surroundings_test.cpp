#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <set>

#include "scene/footprint.hpp"
#include "tubebin/scene/place_surroundings.hpp"

namespace tubebin::scene {
namespace {

using ::testing::HasSubstr;

const SurroundingsOptions kCell = {.table_length = 1.9,
                                   .table_width = 1.5,
                                   .box_count_min = 1,
                                   .box_count_max = 5,
                                   .cylinder_count_min = 1,
                                   .cylinder_count_max = 5,
                                   .bins = 1};

/// A rod that reaches 0.25 m beyond the bin's inner space, towards +y.
PlacedTube hanging_tube(const Bin& bin) {
  tube::Tube rod{.radius = 0.0125, .mass = 0.055, .nodes = {{0, -0.2, 0}, {0, 0.25, 0}}, .cylinders = {{0, 1, 0}}};
  return {rod, make_pose(Quat::Identity(), {0.0, bin.width / 2.0, 0.05})};
}

Surroundings place(const SurroundingsOptions& options, std::uint64_t seed, const Bin& bin = {},
                   const std::vector<PlacedTube>& tubes = {}) {
  Random random(seed);
  const PlacedSurroundings placed = place_surroundings(options, bin, tubes, {Scanner{}}, random);
  EXPECT_EQ(placed.problem, "");
  return placed.surroundings.value();
}

bool is_in(const Vec3& p, const BinPart& part) { return part.box.contains(part.world_from_part.inverse() * p); }

bool is_in(const Vec3& p, const StandingCylinder& cylinder) {
  const Vec3 from = p - cylinder.position;
  return from.z() >= 0.0 && from.z() <= cylinder.height && std::hypot(from.x(), from.y()) <= cylinder.radius;
}

using Solid = std::function<bool(const Vec3&)>;

/// All that stands on the table, each as what tells whether a place is in it.
std::vector<Solid> objects(const Bin& bin, const Surroundings& around) {
  const auto any_of = [](const std::vector<BinPart>& parts) {
    return [parts](const Vec3& p) {
      return std::ranges::any_of(parts, [&](const BinPart& part) { return is_in(p, part); });
    };
  };
  std::vector<Solid> solids = {any_of(bin_parts(bin))};
  Scene scene{.bin = bin, .scanner = {}, .tubes = {}, .surroundings = around};
  const std::vector<BinPart> boxes = surrounding_boxes(scene);
  const std::size_t first_bin = 1 + around.boxes.size();
  for (std::size_t i = 1; i < first_bin; ++i) solids.push_back(any_of({boxes[i]}));
  if (first_bin < boxes.size())
    solids.push_back(any_of({boxes.begin() + static_cast<std::ptrdiff_t>(first_bin), boxes.end()}));
  for (const StandingCylinder& cylinder : around.cylinders)
    solids.push_back([cylinder](const Vec3& p) { return is_in(p, cylinder); });
  return solids;
}

TEST(Surroundings, AreDrawnFromTheSeedAlone) {
  EXPECT_EQ(place(kCell, 7), place(kCell, 7));
  EXPECT_NE(place(kCell, 7), place(kCell, 8));
}

TEST(Surroundings, AreAsManyAndAsLargeAsTheOptionsSay) {
  std::set<std::size_t> box_counts, cylinder_counts;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Surroundings around = place(kCell, seed);
    box_counts.insert(around.boxes.size());
    cylinder_counts.insert(around.cylinders.size());
    EXPECT_EQ(around.bins.size(), 1U);
    EXPECT_EQ(around.table.size, Vec3(1.9, 1.5, kCell.table_thickness));
    for (const StandingBox& box : around.boxes)
      for (const double edge : box.size) {
        EXPECT_GE(edge, kCell.box_size_min);
        EXPECT_LE(edge, kCell.box_size_max);
      }
    for (const StandingCylinder& cylinder : around.cylinders) {
      EXPECT_GE(cylinder.radius, kCell.cylinder_radius_min);
      EXPECT_LE(cylinder.height, kCell.cylinder_height_max);
    }
  }
  EXPECT_THAT(box_counts, ::testing::ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(cylinder_counts, ::testing::ElementsAre(1, 2, 3, 4, 5));
}

TEST(Surroundings, NoPlaceIsInTwoOfThemAndAllStandOnTheTable) {
  const Bin bin{.draft_deg = 6.0, .rim_width = 0.03, .corner_radius = 0.04};
  Random random(3);
  int inside = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Surroundings around = place(kCell, seed, bin);
    const std::vector<Solid> solids = objects(bin, around);
    for (int i = 0; i < 8000; ++i) {
      const Vec3 p(random.uniform(-1.0, 1.0), random.uniform(-0.8, 0.8), random.uniform(-bin.wall_thickness, 0.3));
      const auto count = std::ranges::count_if(solids, [&](const Solid& solid) { return solid(p); });
      ASSERT_LE(count, 1) << "seed " << seed << ": " << p.transpose();
      inside += count > 0;
      if (count > 0) {
        ASSERT_TRUE(std::abs(p.x()) <= 0.95 && std::abs(p.y()) <= 0.75) << p.transpose();
      }
    }
    const double top = around.table.position.z() + around.table.size.z();
    EXPECT_DOUBLE_EQ(top, -bin.wall_thickness);
    for (const StandingBox& box : around.boxes) EXPECT_DOUBLE_EQ(box.position.z(), top);
    for (const StandingCylinder& cylinder : around.cylinders) EXPECT_DOUBLE_EQ(cylinder.position.z(), top);
  }
  EXPECT_GT(inside, 1000);
}

TEST(Surroundings, KeepClearOfATubeThatHangsOut) {
  const Bin bin;
  const PlacedTube tube = hanging_tube(bin);
  int would_touch = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    EXPECT_EQ(find_touching_tube(place(kCell, seed, bin, {tube}), bin, {tube}), "");
    const Surroundings around = place(kCell, seed, bin, {tube});
    for (const Solid& solid : objects(bin, around))
      for (double y = bin.width / 2.0 + 0.03; y < bin.width / 2.0 + 0.25; y += 0.005)
        EXPECT_FALSE(solid({0.0, y, 0.05})) << "seed " << seed;
    would_touch += !find_touching_tube(place(kCell, seed, bin), bin, {tube}).empty();
  }
  EXPECT_GT(would_touch, 3);  // else the tube was in nobody's way
}

TEST(Surroundings, ATableThatIsFullSaysSo) {
  SurroundingsOptions options = kCell;
  options.bins = 0;
  options.box_size_min = options.box_size_max = 0.4;
  options.box_count_min = options.box_count_max = 40;
  Random random(1);
  const PlacedSurroundings placed = place_surroundings(options, Bin{}, {}, {}, random);
  EXPECT_FALSE(placed.surroundings);
  EXPECT_THAT(placed.problem, HasSubstr("found no free place on the table"));
}

TEST(Footprint, DistanceIsThatOfTheNearestOfManyPoints) {
  Random random(5);
  const auto random_footprint = [&] {
    return Footprint{.center = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)},
                     .half_size = {random.uniform(0.0, 0.5), random.uniform(0.0, 0.5)},
                     .yaw = random.uniform(-4.0, 4.0),
                     .radius = random.uniform(0.0, 0.2)};
  };
  const auto points_of = [](const Footprint& footprint) {
    std::vector<Eigen::Vector2d> points;
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(footprint.yaw).toRotationMatrix();
    for (double u = -1.0; u <= 1.001; u += 0.1)
      for (double v = -1.0; v <= 1.001; v += 0.1)
        points.push_back(footprint.center +
                         turn * Eigen::Vector2d(u * footprint.half_size.x(), v * footprint.half_size.y()));
    return points;
  };
  int apart = 0;
  for (int i = 0; i < 30; ++i) {
    const Footprint a = random_footprint(), b = random_footprint();
    double nearest = 10.0;
    for (const Eigen::Vector2d& p : points_of(a))
      for (const Eigen::Vector2d& q : points_of(b)) nearest = std::min(nearest, (p - q).norm());
    EXPECT_NEAR(distance(a, b), std::max(0.0, nearest - a.radius - b.radius), 0.05) << i;
    EXPECT_NEAR(distance(a, b), distance(b, a), 1e-12);
    apart += distance(a, b) > 0.0;
  }
  EXPECT_GT(apart, 5);
  EXPECT_LT(apart, 25);
}

}  // namespace
}  // namespace tubebin::scene
