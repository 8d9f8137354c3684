/// A tube that was followed to a bend, in what a scanner above it saw.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "modeling/built_scene.hpp"
#include "modeling/joining/occlusion.hpp"

namespace tubebin::modeling {

inline const Vec3 kLevel = {-0.1, 0.0, 0.1}, kBend = {0.1, 0.0, 0.1}, kEye = {0.0, 0.0, 1.2};

inline Vec3 ray_at_bend() { return (kEye - kBend).normalized(); }

/// Lengthens paths; true if any changed.
using Step = std::function<bool(std::vector<TubeModel>&, const FilteredCloud&, const std::vector<cloud::Label>&,
                                const ViewProjection&, const OcclusionTest&)>;

struct Followed {
  Vec3 start;
  cloud::Cloud seen;
  scene::Bin bin;
  double spacing;  ///< metres
  std::vector<cloud::Point> points;
  std::vector<cloud::Label> labels;

  void add(const cloud::Point& point, bool has_label) {
    points.push_back(point);
    labels.push_back(has_label ? 1 : 0);
  }

  /// Where the tube ends after the step, whichever of its ends comes first.
  Vec3 end(const Step& step) const {
    TubePath path = followed();
    const TubePath after = path_after(step, path);
    turn_about(path);
    TubePath turned = path_after(step, path);
    turn_about(turned);
    EXPECT_EQ(turned.nodes, after.nodes);
    EXPECT_EQ(turned.bridged, after.bridged);
    EXPECT_EQ(turned.bridge_odds, after.bridge_odds);
    EXPECT_EQ(after.nodes.size(), after.bridged.size() + 1);
    EXPECT_EQ(std::ranges::count(after.bridged, true), std::ssize(after.bridge_odds));
    EXPECT_EQ(after.bridge_odds.front(), kOdds);
    EXPECT_EQ(after.nodes.front(), start);
    return after.nodes.back();
  }

 private:
  static constexpr double kOdds = 5.0;

  /// With a bridge in its middle.
  TubePath followed() const {
    const Vec3 third = (kBend - start) / 3.0;
    return {
        .nodes = {start, start + third, kBend - third, kBend}, .bridged = {false, true, false}, .bridge_odds = {kOdds}};
  }

  TubePath path_after(const Step& step, const TubePath& path) const {
    std::vector<TubeModel> tubes = {{.paths = {path}, .radius = kRadius}};
    const FilteredCloud cloud{.source = {}, .points = points, .normals = {}, .spacing = spacing};
    const ModelingInput input = input_of(seen, bin);
    const ViewProjection projection = view_of(input);
    const bool any = step(tubes, cloud, labels, projection, OcclusionTest(input, projection, spacing, 0.0));
    EXPECT_EQ(any, tubes[0].paths[0].nodes != path.nodes);
    return tubes[0].paths[0];
  }
};

/// `further`: nodes beyond the bend, seen as well.
inline Followed followed_to_bend(const std::vector<Vec3>& further, const Vec3& start = kLevel) {
  std::vector<Vec3> nodes = {start, kBend};
  nodes.insert(nodes.end(), further.begin(), further.end());
  scene::Scene scene = scene_of({tube_along(nodes)});
  scene.scanner = looking_from(kEye);
  scene.scanner.width = 320, scene.scanner.height = 200;  // points a quarter of a radius apart
  const double picture = 2.0 * std::tan(22.5 * std::numbers::pi / 180.0);
  Followed followed{.start = start,
                    .seen = scan::scan(scene).cloud,
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
inline Vec3 off_ray(const Vec3& direction, double degrees) {
  return Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Vec3::UnitY()) * direction;
}

}  // namespace tubebin::modeling
