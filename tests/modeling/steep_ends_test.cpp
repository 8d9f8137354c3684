// Ends of tubes that go on almost straight toward the scanner or away from it.
#include "modeling/steep_ends.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "modeling/built_scene.hpp"

namespace tubebin::modeling {
namespace {

const Vec3 kStart = {-0.1, 0.0, 0.1}, kBend = {0.1, 0.0, 0.1}, kEye = {0.0, 0.0, 1.2};

Vec3 ray_at_bend() { return (kEye - kBend).normalized(); }

/// A tube that lies level and was followed to the bend, in what a scanner above it saw.
struct Followed {
  cloud::Cloud seen;
  scene::Bin bin;
  double spacing;  ///< metres
  std::vector<cloud::Point> points;
  std::vector<cloud::Label> labels;

  void add(const cloud::Point& point, bool has_label) {
    points.push_back(point);
    labels.push_back(has_label ? 1 : 0);
  }

  /// Where the tube ends when its steep side has been looked for.
  Vec3 end() const {
    const std::vector<Vec3> nodes = {kStart, kBend};
    std::vector<TubeModel> tubes = {{.paths = {{.nodes = nodes, .bridged = {false}}}, .radius = kRadius}};
    const FilteredCloud cloud{.source = {}, .points = points, .normals = {}, .spacing = spacing};
    const ModelingInput input = input_of(seen, bin);
    const ViewProjection projection = view_of(input);
    const bool any = reach_steep_ends(tubes, cloud, labels, projection, OcclusionTest(input, projection, spacing, 0.0));
    const TubePath& path = tubes[0].paths[0];
    EXPECT_EQ(any, path.nodes != nodes);
    EXPECT_EQ(path.nodes.size(), path.bridged.size() + 1);
    EXPECT_EQ(path.nodes.front(), kStart);
    return path.nodes.back();
  }
};

/// `further`: nodes beyond the bend, seen as well.
Followed followed_to_bend(const std::vector<Vec3>& further) {
  std::vector<Vec3> nodes = {kStart, kBend};
  nodes.insert(nodes.end(), further.begin(), further.end());
  scene::Scene scene = scene_of({tube_along(nodes)});
  scene.scanner = looking_from(kEye);
  scene.scanner.width = 320, scene.scanner.height = 200;  // points a quarter of a radius apart
  const double picture = 2.0 * std::tan(22.5 * std::numbers::pi / 180.0);
  Followed followed{.seen = scan::scan(scene).cloud,
                    .bin = scene.bin,
                    .spacing = picture * (kEye - kBend).norm() / 320.0,
                    .points = {},
                    .labels = {}};
  const cloud::Cloud& seen = followed.seen;
  for (std::size_t i = 0; i < seen.points.size(); ++i)
    if (seen.labels[i] > 0) followed.add(seen.points[i], seen.points[i].x() < kBend.x() - kRadius);
  return followed;
}

/// Turned by so many degrees about the y axis, outward from the view's middle.
Vec3 off_ray(const Vec3& direction, double degrees) {
  return Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Vec3::UnitY()) * direction;
}

TEST(SteepEnds, ASideSeenAtAFewDegreesIsFollowedToItsEnd) {
  for (const double degrees : {8.0, 12.0, 25.0}) {
    const Vec3 end = kBend + 0.15 * off_ray(ray_at_bend(), degrees);
    EXPECT_LT((followed_to_bend({end}).end() - end).norm(), kRadius) << degrees << " degrees";
  }
}

TEST(SteepEnds, WhereNothingGoesOnTheEndStays) { EXPECT_EQ(followed_to_bend({}).end(), kBend); }

TEST(SteepEnds, PointsWhereTheScanSawThroughAreNone) {
  Followed followed = followed_to_bend({});
  const Followed steep = followed_to_bend({kBend + 0.15 * off_ray(ray_at_bend(), 12.0)});
  for (std::size_t i = 0; i < steep.points.size(); ++i)
    if (steep.labels[i] == 0) followed.add(steep.points[i], false);
  EXPECT_EQ(followed.end(), kBend);
}

TEST(SteepEnds, PointsInTheAirBehindAnEdgeAreNone) {
  Followed followed = followed_to_bend({});
  const Vec3 ray = ray_at_bend(), side = ray.unitOrthogonal(), up = ray.cross(side);
  for (double angle = 0.0; angle < 2.0 * std::numbers::pi; angle += 0.3)
    for (double back = 0.0; back < 0.15; back += 0.005) {
      const Vec3 edge = kBend + kRadius * (std::cos(angle) * side + std::sin(angle) * up);
      followed.add((edge - back * (kEye - edge).normalized()).cast<float>(), false);
    }
  EXPECT_EQ(followed.end(), kBend);
}

}  // namespace
}  // namespace tubebin::modeling
