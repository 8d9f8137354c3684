#include "modeling/input/bin_faces.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "modeling/askew_bin.hpp"

namespace tubebin::modeling {
namespace {

constexpr double kTolerance = 0.0005, kMargin = 0.002;  // metres

/// A region of 20 mm by 20 mm. Places and directions in the bin's frame, metres.
FlatRegion region_at(const Vec3& center, const Vec3& normal) {
  FlatRegion region;
  region.center = kAskewBin.world_from_bin * center;
  region.plane.normal = kAskewBin.world_from_bin.linear() * normal;
  region.plane.offset = region.plane.normal.dot(region.center);
  region.half_extents[0] = region.half_extents[1] = 0.01;
  region.tolerance = kTolerance;
  return region;
}

/// Of points given in the bin's frame: whether each lies on a face.
std::vector<bool> are_on_faces(const std::vector<FlatRegion>& regions, const std::vector<Vec3>& places) {
  std::vector<cloud::Point> points;
  for (const Vec3& place : places) points.push_back((kAskewBin.world_from_bin * place).cast<float>());
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0U);
  std::vector<bool> are_on(points.size(), false);
  for (const std::uint32_t i : points_on_faces(kAskewBin, regions, points, all, kMargin)) are_on[i] = true;
  return are_on;
}

using Are = std::vector<bool>;

TEST(BinFaces, GoOnBeyondWhatIsSeenOfThemAtOnce) {
  const std::vector<FlatRegion> regions = {region_at({-0.1, 0.1, 0.05}, -Vec3::UnitY()),
                                           region_at({0.05, 0.0, 0.0}, Vec3::UnitZ())};
  EXPECT_EQ(are_on_faces(regions, {{0.14, 0.1, 0.09}, {-0.14, 0.1, 0.01}, {-0.14, -0.09, 0.0}}),
            Are({true, true, true}));
}

TEST(BinFaces, EndAtTheBinsEdgesAndAtTheirPlanes) {
  const std::vector<FlatRegion> regions = {region_at({-0.1, 0.1, 0.05}, -Vec3::UnitY())};
  const double wide = kAskewBin.length / 2.0 + 0.26 * kAskewBin.height + kMargin;
  EXPECT_EQ(are_on_faces(regions, {{0.1, 0.1, 0.103}, {wide + 0.001, 0.1, 0.05}, {0.1, 0.0994, 0.05}, {0.1, 0.0, 0.0}}),
            Are({false, false, false, false}));
}

TEST(BinFaces, AreTheFloorAndWallsThatLeanALittle) {
  const auto leaning = [](double degrees) {
    const double angle = degrees * std::numbers::pi / 180.0;
    return region_at({-0.1, 0.1, 0.0}, Vec3(0.0, -std::cos(angle), std::sin(angle)));
  };
  const auto on_leaning = [](double degrees) -> Vec3 {
    return {0.1, 0.1 + 0.05 * std::tan(degrees * std::numbers::pi / 180.0), 0.05};
  };
  EXPECT_EQ(are_on_faces({leaning(6.0)}, {on_leaning(6.0)}), Are({true}));
  EXPECT_EQ(are_on_faces({leaning(30.0)}, {on_leaning(30.0)}), Are({false}));
  EXPECT_EQ(are_on_faces({region_at({0.05, 0.0, 0.1}, Vec3::UnitZ())}, {{-0.1, 0.0, 0.1}}), Are({false})) << "a rim";
  EXPECT_EQ(are_on_faces({region_at({0.05, 0.3, 0.05}, -Vec3::UnitY())}, {{0.05, 0.3, 0.05}}), Are({false}))
      << "another's";
}

}  // namespace
}  // namespace tubebin::modeling
