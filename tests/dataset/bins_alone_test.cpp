// When scenes share the scan of their bin.
#include "dataset/bins_alone.hpp"

#include <gtest/gtest.h>

namespace tubebin::testing {

using namespace dataset;
namespace {

Piles piles_in_bin(double height, std::size_t count, const DrawnNumbers& drawn) {
  Piles piles;
  piles.config.scanner.width = 120;
  piles.config.scanner.height = 80;
  piles.config.bin.height = height;  // metres
  piles.drawn = drawn;
  piles.piles.resize(count);
  return piles;
}

TEST(BinsAlone, AreScannedOnceWhereNothingIsDrawn) {
  BinsAlone bins_alone;
  const std::vector<scan::Scan>& scans = bins_alone.of(piles_in_bin(0.2, 1, {}));
  ASSERT_EQ(scans.size(), 1u);
  const cloud::Point* points = scans.front().cloud.points.data();
  EXPECT_EQ(bins_alone.of(piles_in_bin(0.2, 1, {})).front().cloud.points.data(), points);
}

TEST(BinsAlone, AreThoseOfTheBinThatWasDrawn) {
  BinsAlone bins_alone;
  for (const double height : {0.2, 0.3, 0.2}) {
    const Piles piles = piles_in_bin(height, 3, {{"bin.height", height}});
    const std::vector<scan::Scan> fresh = scan::scan_bin_alone(scene_of(piles.config, piles.piles.front()));
    ASSERT_EQ(bins_alone.of(piles).size(), 1u);
    EXPECT_EQ(bins_alone.of(piles).front().window, fresh.front().window);
    EXPECT_EQ(bins_alone.of(piles).front().cloud.labels, fresh.front().cloud.labels);
  }
}

TEST(BinsAlone, AreNoneWhereABinIsDrawnForOneScene) {
  BinsAlone bins_alone;
  EXPECT_FALSE(bins_alone.of(piles_in_bin(0.2, 3, {{"bin.height", 0.2}})).empty());
  EXPECT_TRUE(bins_alone.of(piles_in_bin(0.3, 1, {{"bin.height", 0.3}})).empty());
}

}  // namespace
}  // namespace tubebin::testing
