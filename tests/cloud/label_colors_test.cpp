#include "tubebin/cloud/label_colors.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "tubebin/core/error.hpp"

namespace tubebin::cloud {
namespace {

/// "Redmean" distance (T. Riemersma, "Colour metric"): a second opinion on how different two colours look, 0
/// to 765.
double redmean(Color a, Color b) {
  const auto channel = [](Color color, int shift) { return static_cast<double>(color >> shift & 0xFF); };
  const double mean = (channel(a, 16) + channel(b, 16)) / 2.0;
  const double dr = channel(a, 16) - channel(b, 16);
  const double dg = channel(a, 8) - channel(b, 8);
  const double db = channel(a, 0) - channel(b, 0);
  return std::sqrt((2 + mean / 256) * dr * dr + 4 * dg * dg + (2 + (255 - mean) / 256) * db * db);
}

double closest_pair(const std::vector<Color>& colors) {
  double closest = 1e9;
  for (std::size_t i = 0; i < colors.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) closest = std::min(closest, redmean(colors[i], colors[j]));
  return closest;
}

TEST(LabelColors, AreUniqueAndNeverTheNullColor) {
  for (const std::size_t count : {0, 1, 20, 200, 2000}) {
    const std::vector<Color> colors = label_colors(count);
    ASSERT_EQ(colors.size(), count + 1);
    const std::set<Color> unique(colors.begin(), colors.end());
    EXPECT_EQ(unique.size(), count + 1);
    EXPECT_FALSE(unique.contains(kNullColor));
    EXPECT_LE(*unique.rbegin(), 0xFFFFFFU);
  }
}

TEST(LabelColors, TheBinIsGreyAndALabelKeepsItsColorInEveryScene) {
  const std::vector<Color> many = label_colors(50);
  EXPECT_EQ(many[0] >> 16, many[0] & 0xFF);
  EXPECT_EQ(many[0] >> 8 & 0xFF, many[0] & 0xFF);
  for (std::size_t count = 0; count < 50; ++count)
    EXPECT_EQ(label_colors(count), std::vector<Color>(many.begin(), many.begin() + static_cast<long>(count) + 1));
}

TEST(LabelColors, AreWellApartUpToTwentyTubes) {
  EXPECT_GE(closest_pair(label_colors(5)), 150.0);
  EXPECT_GE(closest_pair(label_colors(10)), 100.0);
  EXPECT_GE(closest_pair(label_colors(20)), 60.0);
  std::vector<Color> with_null = label_colors(20);
  with_null.push_back(kNullColor);
  EXPECT_GE(closest_pair(with_null), 60.0);
}

TEST(LabelColors, MoreTubesThanColorsAreRefused) { EXPECT_THROW(label_colors(100'000'000), ConfigError); }

}  // namespace
}  // namespace tubebin::cloud
