#include "modeling/fitting/piece_cleaning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "modeling/built_scene.hpp"

namespace tubebin::modeling {
namespace {

constexpr double kRowSpacing = 0.0015;  // metres

/// A cylinder along x at height z; its points cover the angles from `first` to `last` (radians from y) about the axis.
TubePiece strip(double z, double x_from, double x_to, double first, double last, std::vector<cloud::Point>& points) {
  TubePiece piece{.nodes = {{x_from, 0, z}, {x_to, 0, z}}, .radius = kRadius, .points = {}};
  for (double x = x_from; x <= x_to; x += kRowSpacing)
    for (double angle = first; angle <= last; angle += kRowSpacing / kRadius) {
      piece.points.push_back(static_cast<std::uint32_t>(points.size()));
      points.push_back(Vec3(x, kRadius * std::cos(angle), z + kRadius * std::sin(angle)).cast<float>());
    }
  return piece;
}

TEST(PieceCleaning, DropsWhatAnotherPieceOfTheSameTubeExplains) {
  constexpr double kPi = std::numbers::pi;
  std::vector<cloud::Point> points;
  const TubePiece tube = strip(0.02, 0.0, 0.3, 0.3, kPi, points);
  const TubePiece again = strip(0.02, 0.1, 0.2, 0.0, 0.3, points);
  const TubePiece other = strip(0.2, 0.1, 0.2, 0.0, 0.3, points);
  std::vector<TubePiece> pieces = {again, tube, other};
  drop_explained_pieces(pieces, points, kRowSpacing);
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(pieces[0].points, tube.points);
  EXPECT_EQ(pieces[1].points, other.points);
}

}  // namespace
}  // namespace tubebin::modeling
