#include "modeling/input/radius_estimation.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "modeling/built_surface.hpp"

namespace tubebin::modeling {
namespace {

std::vector<double> sorted_radii(const CurvedPlaces& places) {
  std::vector<double> radii;
  for (const TubularPlace& place : places.tubular) radii.push_back(place.radius);
  std::ranges::sort(radii);
  return radii;
}

TEST(RadiusEstimation, PlacesOnATubeCurveAsItDoes) {
  for (const double radius : {0.008, 0.0125, 0.03}) {
    const FilteredCloud cloud = upper_half_of({{-0.1, 0, 0}, {0.1, 0, 0}}, radius);
    const CurvedPlaces places = curved_places_of(cloud, radius);
    const std::vector<double> radii = sorted_radii(places);
    ASSERT_GT(radii.size(), 0.9 * static_cast<double>(places.looked_at));
    EXPECT_NEAR(radii[radii.size() / 2], radius, 0.05 * radius);
    // At the half's edges all neighbours are on one side.
    const std::size_t quarter = radii.size() / 4;
    EXPECT_NEAR(radii[quarter], radius, 0.15 * radius);
    EXPECT_NEAR(radii[radii.size() - quarter], radius, 0.15 * radius);
    std::size_t on_axis = 0;
    for (const TubularPlace& place : places.tubular)
      if (std::hypot(place.center.y(), place.center.z()) < 0.2 * radius && std::abs(place.axis.x()) > 0.98) ++on_axis;
    EXPECT_GT(on_axis, places.tubular.size() / 2);
  }
}

TEST(RadiusEstimation, PlacesWherePointsLieFarCloserThanElsewhereCurveAsTheTubeDoes) {
  FilteredCloud cloud = upper_half_of({{-0.1, 0, 0}, {0.1, 0, 0}}, 0.03);
  cloud.spacing *= 4.0;
  const CurvedPlaces places = curved_places_of(cloud);
  const std::vector<double> radii = sorted_radii(places);
  ASSERT_GT(radii.size(), 0.9 * static_cast<double>(places.looked_at));
  EXPECT_NEAR(radii[radii.size() / 2], 0.03, 0.0015);
}

/// Glossy and dark tubes show a narrow strip. Normals at the points themselves would have a third of its curvature: all of its
/// points have nearly the same neighbours.
TEST(RadiusEstimation, PlacesOnANarrowStripCurveAsTheTubeDoes) {
  constexpr double kTube = 0.005, kHalfWidth = 0.0035;
  FilteredCloud strip = upper_half_of({{-0.1, 0, 0}, {0.1, 0, 0}}, kTube);
  std::erase_if(strip.points, [](const cloud::Point& p) { return std::abs(double(p.y())) > kHalfWidth; });
  strip.source.resize(strip.points.size());
  const CurvedPlaces places = curved_places_of(strip);
  const std::vector<double> radii = sorted_radii(places);
  ASSERT_GT(radii.size(), 0.5 * static_cast<double>(places.looked_at));
  EXPECT_NEAR(radii[radii.size() / 2], kTube, 0.2 * kTube);
}

TEST(RadiusEstimation, WhatIsFlatOrCurvesBothWaysHasNoRadius) {
  FilteredCloud ball{.source = {}, .points = {}, .normals = {}, .spacing = 0.001}, plane = ball;
  for (double x = -0.02; x <= 0.02; x += ball.spacing)
    for (double y = -0.02; y <= 0.02; y += ball.spacing) {
      ball.points.push_back((0.03 * Vec3(x, y, 0.03).normalized()).cast<float>());
      plane.points.push_back(Vec3(x, y, 0).cast<float>());
    }
  for (const FilteredCloud& cloud : {ball, plane}) {
    const CurvedPlaces places = curved_places_of(cloud);
    EXPECT_GT(places.looked_at, 300u);
    EXPECT_TRUE(places.tubular.empty());
  }
}

TEST(RadiusEstimation, TheCommonestRadiusIsTheOneThatMostPlacesShow) {
  std::vector<TubularPlace> places;
  for (const double radius : {0.010, 0.3, 0.011, 0.0102, 0.0098, 0.02, 0.021, 0.0205, 0.05})
    places.push_back({.radius = radius, .center = Vec3::Zero(), .axis = Vec3::UnitX()});
  EXPECT_DOUBLE_EQ(commonest_radius(places, {}).radius, 0.0102);
  EXPECT_EQ(commonest_radius(places, {}).places, 4u);
  EXPECT_DOUBLE_EQ(commonest_radius(places, {0.0105}).radius, 0.0205);
  EXPECT_EQ(commonest_radius({}, {}).places, 0u);
  EXPECT_TRUE(is_tried(0.0100, {0.02, 0.0105}));
  EXPECT_FALSE(is_tried(0.0100, {0.02, 0.0120}));
}

/// The points of a tube of 13 mm, a bend in it, modeled with 12.5 mm.
TEST(RadiusEstimation, IsRefinedToThatOfThePointsAboutThePieces) {
  constexpr double kTrue = 0.013;
  const std::vector<Vec3> nodes = {{-0.1, 0, 0}, {0, 0, 0}, {0.08, 0.06, 0}};
  FilteredCloud cloud = upper_half_of(nodes, kTrue);
  TubePiece piece{.nodes = nodes, .radius = kRadius, .points = cloud.source};
  for (Vec3& node : piece.nodes) node += Vec3(0.0, 0.0003, -0.0003);  // as a fit of the wrong radius is off
  EXPECT_NEAR(refine_radius({piece}, cloud.points, kRadius), kTrue, 5e-5);
  Random random(4);
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    cloud.points[i] += static_cast<float>(0.0003 * random.normal()) * cloud.normals[i];
  EXPECT_NEAR(refine_radius({piece}, cloud.points, kRadius), kTrue, 0.0001);
  piece.nodes = {{-0.09, 0, 0}, {-0.07, 0, 0}};  // shorter than it is wide
  EXPECT_NEAR(refine_radius({piece}, cloud.points, kRadius), kTrue, 0.0002);
  piece.nodes = {{-0.09, 0, 0}, {-0.08, 0, 0}};
  EXPECT_EQ(refine_radius({piece}, cloud.points, kRadius), kRadius);
}

}  // namespace
}  // namespace tubebin::modeling
