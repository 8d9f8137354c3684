// What was found of each radius before others were known, and what of it stays once they are.
#include "modeling/fitting/possible_classes.hpp"

#include <gtest/gtest.h>

#include "modeling/built_surface.hpp"

namespace tubebin::modeling {
namespace {

const std::vector<Vec3> kAlongX = {{-0.1, 0, 0}, {0.1, 0, 0}}, kBeside = {{-0.1, 0.1, 0}, {0.1, 0.1, 0}};

TubePiece piece_along(const std::vector<Vec3>& nodes, double radius) {
  return {.nodes = nodes, .radius = radius, .points = {}};
}

/// A piece of half the radius, fitted to points of a tube along the nodes.
UnsurePiece unsure_along(const std::vector<Vec3>& nodes) {
  return {.piece = piece_along(nodes, kRadius / 2.0), .off = 0.1, .points = upper_half_of(nodes).points};
}

PossibleClass class_of(double radius, std::vector<TubePiece> sure, std::vector<UnsurePiece> unsure) {
  return {.sure = {.radius = radius, .radius_error = 0.0, .pieces = std::move(sure)}, .unsure = std::move(unsure)};
}

TEST(PossibleClasses, UnsurePiecesGoToTheRadiusThatExplainsTheirPoints) {
  const std::vector<TubeClass> classes =
      settled(std::vector{class_of(kRadius, {piece_along(kAlongX, kRadius)}, {}),
                          class_of(kRadius / 2.0, {}, {unsure_along(kAlongX), unsure_along(kBeside)})},
              upper_half_of(kAlongX).spacing);
  ASSERT_EQ(classes.size(), 2u);
  EXPECT_EQ(classes[0].pieces.size(), 1u);
  ASSERT_EQ(classes[1].pieces.size(), 1u);
  EXPECT_EQ(classes[1].pieces[0].nodes, kBeside);
}

TEST(PossibleClasses, OtherUnsurePiecesExplainNone) {
  const std::vector<TubeClass> classes = settled(
      std::vector{class_of(kRadius, {}, {unsure_along(kAlongX)}), class_of(kRadius / 2.0, {}, {unsure_along(kAlongX)})},
      upper_half_of(kAlongX).spacing);
  EXPECT_EQ(classes[0].pieces.size(), 1u);
  EXPECT_EQ(classes[1].pieces.size(), 1u);
}

TEST(PossibleClasses, APieceIsKnownWhereAnEarlierOneIsHardlyWorse) {
  const std::vector<PossibleClass> earlier = {class_of(kRadius / 2.0, {}, {unsure_along(kAlongX)})};
  EXPECT_TRUE(is_known(piece_along(kAlongX, kRadius), 0.06, earlier));
  EXPECT_FALSE(is_known(piece_along(kAlongX, kRadius), 0.04, earlier));
  EXPECT_FALSE(is_known(piece_along(kBeside, kRadius), 0.06, earlier));
}

}  // namespace
}  // namespace tubebin::modeling
