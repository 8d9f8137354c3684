#include "modeling/fitting/wire_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tubebin/core/geometry.hpp"

namespace tubebin::modeling {
namespace {

constexpr double kWireRadius = 0.003;  // metres

TubePiece straight_wire(const Vec3& from, const Vec3& to) {
  return {.nodes = {from, (from + to) / 2.0, to}, .radius = kWireRadius, .points = {}};
}

/// `count` pieces along x and as many along y on top of them, so far apart, turned by `turn` degrees each in turn.
std::vector<TubePiece> crossed_wires(int count, double apart, double turn) {
  std::vector<TubePiece> pieces;
  for (int k = 0; k < count; ++k) {
    const double at = k * apart, lean = 0.15 * std::tan(radians(k % 3 * turn));
    pieces.push_back(straight_wire({-0.3, at - lean, 0}, {0.3, at + lean, 0}));
    pieces.push_back(straight_wire({at - lean, -0.3, 2 * kWireRadius}, {at + lean, 0.3, 2 * kWireRadius}));
  }
  return pieces;
}

TEST(WireMesh, IsMadeOfCrossedWiresFarApart) { EXPECT_TRUE(is_wire_mesh(crossed_wires(15, 10 * kWireRadius, 0.0))); }

TEST(WireMesh, MayBeCutByWhatLiesOnIt) {
  std::vector<TubePiece> pieces = crossed_wires(15, 10 * kWireRadius, 0.0);
  for (TubePiece& piece : pieces) piece.nodes.back() = piece.nodes[1];
  EXPECT_TRUE(is_wire_mesh(pieces));
}

TEST(WireMesh, FewWiresMayBeTubes) { EXPECT_FALSE(is_wire_mesh(crossed_wires(10, 10 * kWireRadius, 0.0))); }

TEST(WireMesh, LayersOfRodsThatTouchAreNone) { EXPECT_FALSE(is_wire_mesh(crossed_wires(15, 2 * kWireRadius, 0.0))); }

TEST(WireMesh, TubesThatLieAnyhowAreNone) { EXPECT_FALSE(is_wire_mesh(crossed_wires(15, 10 * kWireRadius, 10.0))); }

TEST(WireMesh, BentTubesAreNone) {
  std::vector<TubePiece> pieces = crossed_wires(15, 10 * kWireRadius, 0.0);
  for (std::size_t k = 0; k < pieces.size(); k += 2) pieces[k].nodes[1] += Vec3(0, 0.05, 0);
  EXPECT_FALSE(is_wire_mesh(pieces));
}

TEST(WireMesh, ParallelRodsAreNone) {
  std::vector<TubePiece> pieces;
  for (int k = 0; k < 30; ++k)
    pieces.push_back(straight_wire({0, k * 10 * kWireRadius, 0}, {0.3, k * 10 * kWireRadius, 0}));
  EXPECT_FALSE(is_wire_mesh(pieces));
}

}  // namespace
}  // namespace tubebin::modeling
