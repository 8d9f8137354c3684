#include "modeling/fitting/piece_evidence.hpp"

#include <gtest/gtest.h>

#include "modeling/built_surface.hpp"

namespace tubebin::modeling {
namespace {

/// Of a tube through the nodes of which the cloud's points were measured.
PieceEvidence evidence_of(const std::vector<Vec3>& nodes, const FilteredCloud& cloud) {
  const ModelingInput input{
      .points = cloud.points, .world_from_sensor = make_pose(Quat(0, 1, 0, 0), {0, 0, 1}), .bin = {}};
  const OcclusionTest occlusion(input, view_from_above(), cloud.spacing, kRadius);
  return examine_piece({.nodes = nodes, .radius = kRadius, .points = cloud.source}, cloud, occlusion);
}

PieceEvidence evidence_of(const std::vector<Vec3>& nodes) { return evidence_of(nodes, upper_half_of(nodes)); }

/// A centreline that winds about a can twice as wide as it is thick.
std::vector<Vec3> helix(double rise_of_turn) {
  std::vector<Vec3> nodes;
  for (int k = 0; k <= 36; ++k) {
    const double turns = k / 12.0, angle = 2.0 * std::numbers::pi * turns;
    nodes.emplace_back(2.0 * kRadius * std::cos(angle), 2.0 * kRadius * std::sin(angle), turns * rise_of_turn);
  }
  return nodes;
}

TEST(PieceEvidence, IsATubeWhereItIsOne) {
  const PieceEvidence evidence = evidence_of({{-0.1, 0, 0}, {0, 0.02, 0}, {0.08, 0.08, 0}});
  EXPECT_NEAR(evidence.curvature, 1.0, 0.05);
  EXPECT_EQ(evidence.coiled, 0.0);
  EXPECT_TRUE(is_tube(evidence, kRadius, 0.0));
}

/// Of a tube that points at the scanner, and is dark, hardly more than the flat end and a narrow strip is measured.
TEST(PieceEvidence, CountsNoFlatEndAsASide) {
  const std::vector<Vec3> nodes = {{-0.05, 0, 0}, {0.05, 0, 0}};
  const FilteredCloud whole = upper_half_of(nodes);
  FilteredCloud strip{.source = {}, .points = {}, .normals = {}, .spacing = whole.spacing};
  const auto add = [&](const cloud::Point& point, const cloud::Point& normal) {
    strip.source.push_back(static_cast<std::uint32_t>(strip.points.size()));
    strip.points.push_back(point);
    strip.normals.push_back(normal);
  };
  for (std::size_t i = 0; i < whole.points.size(); ++i)
    if (whole.normals[i].z() > 0.9f) add(whole.points[i], whole.normals[i]);
  for (double y = -kRadius; y <= kRadius; y += whole.spacing / 2.0)
    for (double z = -kRadius; z <= kRadius; z += whole.spacing / 2.0)
      if (std::hypot(y, z) < kRadius) add(Vec3(0.0499, y, z).cast<float>(), cloud::Point::UnitX());
  const PieceEvidence evidence = evidence_of(nodes, strip);
  EXPECT_NEAR(evidence.curvature, 1.0, 0.05);
  EXPECT_LT(evidence.sigma, 0.01 * kRadius);
}

TEST(PieceEvidence, IsCoiledWhereItsTurnsShareOnePlace) {
  EXPECT_GT(evidence_of(helix(0.8 * kRadius)).coiled, 0.9);
  EXPECT_EQ(evidence_of(helix(2.5 * kRadius)).coiled, 0.0);  // a spring is one tube beside itself
}

TEST(PieceEvidence, TakesNoCoilForATube) {
  PieceEvidence evidence = evidence_of({{-0.1, 0, 0}, {0.1, 0, 0}});
  ASSERT_TRUE(is_tube(evidence, kRadius, 0.0));
  evidence.coiled = evidence_of(helix(0.8 * kRadius)).coiled;
  EXPECT_FALSE(is_tube(evidence, kRadius, 0.0));
}

TubePiece piece_through(const std::vector<Vec3>& nodes) { return {.nodes = nodes, .radius = kRadius, .points = {}}; }

TEST(PieceEvidence, StandsWhereItIsStraightAndUpright) {
  const Vec3 up = Vec3(0.2, -0.1, 1.0).normalized(), level = up.unitOrthogonal();
  const auto leaning = [&](double degrees) {
    const double angle = degrees * std::numbers::pi / 180.0;
    return piece_through({Vec3::Zero(), 0.2 * (std::cos(angle) * up + std::sin(angle) * level)});
  };
  EXPECT_TRUE(stands_upright(leaning(0.0), up));
  EXPECT_TRUE(stands_upright(leaning(180.0), up));
  EXPECT_TRUE(stands_upright(leaning(2.0), up));
  EXPECT_FALSE(stands_upright(leaning(10.0), up));
  EXPECT_FALSE(stands_upright(leaning(90.0), up));
  EXPECT_FALSE(stands_upright(leaning(0.0), Vec3::Zero()));
  EXPECT_FALSE(stands_upright(piece_through({-0.1 * up, Vec3(0.05 * level), 0.1 * up}), up));  // a bend
  EXPECT_FALSE(stands_upright(piece_through({Vec3::Zero(), Vec3(kRadius * up)}), up));         // too short to tell
}

TEST(PieceEvidence, AnUprightPieceGoesOnWhereAnotherEnds) {
  const TubePiece upright = piece_through({Vec3::Zero(), {0.0, 0.0, 0.1}});
  EXPECT_TRUE(goes_on(upright, {{0.5, 0.0, 0.0}, {0.0, kRadius, -0.5 * kRadius}}));
  EXPECT_TRUE(goes_on(upright, {{0.0, 0.0, 0.1 + kRadius}}));
  EXPECT_FALSE(goes_on(upright, {{0.0, 0.0, 0.1 + 2.0 * kRadius}, {0.0, kRadius, 0.05}}));  // the latter leans on it
  EXPECT_FALSE(goes_on(upright, {}));
}

TEST(PieceEvidence, IsInsideWhereMostOfItsCentrelineIs) {
  const TubePiece bottle{.nodes = {{0, 0, 0}, {0, 0, 0.3}}, .radius = 0.06, .points = {}};
  EXPECT_TRUE(is_inside(piece_through({{0.05, 0, 0.02}, {0.045, 0.01, 0.1}, {0.05, 0, 0.25}}), bottle));
  EXPECT_FALSE(is_inside(piece_through({{0.075, 0, 0.02}, {0.08, 0, 0.25}}), bottle));             // leans on it
  EXPECT_FALSE(is_inside(piece_through({{0.05, 0, 0.1}, {0.2, 0, 0.1}, {0.3, 0, 0.1}}), bottle));  // ends at it
}

}  // namespace
}  // namespace tubebin::modeling
