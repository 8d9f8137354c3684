#include "modeling/input/bin_rim.hpp"

#include <gtest/gtest.h>

#include "modeling/askew_bin.hpp"

namespace tubebin::modeling {
namespace {

constexpr double kSpacing = 0.001, kWall = 0.004;  // metres

struct Scan {
  std::vector<cloud::Point> points;
  std::vector<std::uint32_t> indices;

  void add(double x, double y, double z) {
    indices.push_back(static_cast<std::uint32_t>(points.size()));
    points.push_back((kAskewBin.world_from_bin * Vec3(x, y, z)).cast<float>());
  }
  /// The upper sides of the walls, of thickness `wall`, which lean outward by `lean`; every `step`th row of them.
  void add_rim(double wall, int step, double lean = 0.0) {
    const double x_in = kAskewBin.length / 2.0 + lean, y_in = kAskewBin.width / 2.0 + lean;
    const double x_out = x_in + wall, y_out = y_in + wall;
    int row = 0;
    for (double x = -x_out + kSpacing / 2.0; x < x_out; x += kSpacing, ++row)
      for (double y = -y_out + kSpacing / 2.0; y < y_out; y += kSpacing)
        if ((std::abs(x) > x_in || std::abs(y) > y_in) && row % step == 0) add(x, y, kAskewBin.height);
  }
};

TEST(BinRim, IsAsWideAsItSurroundsTheBin) {
  Scan scan;
  scan.add_rim(kWall, 1);
  const std::vector<std::uint32_t> rim = scan.indices;
  // A level tube's upper side at the same height, in the bin and far over its wall; and points on the floor.
  for (double x = 0.0; x < 0.2; x += kSpacing)
    if (std::abs(x - kAskewBin.length / 2.0) > 2.0 * kWall) scan.add(x, 0.0, kAskewBin.height);
  for (double x = 0.0; x < 0.1; x += kSpacing) scan.add(x, 0.05, 0.0);
  EXPECT_EQ(points_on_rim(kAskewBin, scan.points, scan.indices, 0.0005, kSpacing), rim);
}

TEST(BinRim, LiesFartherOutWhereWallsLean) {
  Scan scan;
  scan.add_rim(kWall, 1, 0.026);
  const std::vector<std::uint32_t> rim = scan.indices;
  for (double x = 0.0; x < kAskewBin.length / 2.0; x += kSpacing) scan.add(x, 0.0, kAskewBin.height);
  EXPECT_EQ(points_on_rim(kAskewBin, scan.points, scan.indices, 0.0005, kSpacing), rim);
}

TEST(BinRim, MayBeHigherOnOneWallThanOnAnother) {
  Scan scan, uneven;
  scan.add_rim(kWall, 1);
  for (const cloud::Point& point : scan.points) {
    const Vec3 p = kAskewBin.world_from_bin.inverse() * point.cast<double>();
    const double out = p.x() - kAskewBin.length / 2.0;
    const bool is_far_wall = out > 0.0 && out > std::abs(p.y()) - kAskewBin.width / 2.0;
    uneven.add(p.x(), p.y(), is_far_wall ? p.z() + 0.003 : p.z());
  }
  const std::vector<std::uint32_t> rim = uneven.indices;
  for (double y = -0.05; y < 0.05; y += kSpacing) uneven.add(kAskewBin.length / 2.0 + kWall / 2.0, y, kAskewBin.height);
  EXPECT_EQ(points_on_rim(kAskewBin, uneven.points, uneven.indices, 0.0005, kSpacing), rim);
}

TEST(BinRim, IsNotWhatLiesHereAndThere) {
  Scan scan;
  scan.add_rim(kWall, 10);
  EXPECT_TRUE(points_on_rim(kAskewBin, scan.points, scan.indices, 0.0005, kSpacing).empty());
}

}  // namespace
}  // namespace tubebin::modeling
