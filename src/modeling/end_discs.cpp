#include "modeling/end_discs.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "modeling/input/flat_blocks.hpp"
#include "modeling/input/point_sample.hpp"
#include "modeling/path_ends.hpp"

namespace tubebin::modeling {
namespace {

/// Radii: how far from a tube's tip the middle of its disc may be, and how far from it points tell where the disc ends.
constexpr double kFarthest = 8.0, kAround = 2.0;
constexpr std::size_t kFewPoints = 10;

FittedPlane plane_of(std::span<const Vec3> points) {
  PointMoments moments;
  for (const Vec3& point : points) moments.add(point);
  return FittedPlane(moments);
}

/// Those closer than `distance` metres to a place.
std::vector<Vec3> within(const Vec3& place, double distance, std::span<const Vec3> points) {
  std::vector<Vec3> found;
  for (const Vec3& point : points)
    if ((point - place).squaredNorm() < distance * distance) found.push_back(point);
  return found;
}

/// Those on the plane, not farther than `distance` metres from its center.
std::vector<Vec3> on_plane(const FittedPlane& plane, double radius, double distance, std::span<const Vec3> points) {
  constexpr double kFlat = 0.1;  // radii
  std::vector<Vec3> found = within(plane.center, distance, points);
  std::erase_if(found,
                [&](const Vec3& point) { return std::abs((point - plane.center).dot(plane.normal)) > kFlat * radius; });
  return found;
}

/// A path's end from which a disc can be reached.
struct ReachableDisc {
  TubeModel* tube;
  TubePath* path;
  bool is_last;  ///< of the path's two ends
  EndDisc disc;
  double turn;  ///< radians, on the way
};

/// How far a tube turns on its way from an end to the disc, radians. Near the disc the way's own direction says little.
double turn_to(const EndDisc& disc, const PathEnd& end, double radius) {
  const Vec3 way = disc.center - end.tip;
  if (way.norm() < kAround * radius) return angle_between(end.outward, disc.outward);
  return angle_between(end.outward, way) + angle_between(way, disc.outward);
}

/// Whether the scan sees through a tube on its way from the tip to the disc.
bool is_seen_through(const Vec3& tip, const EndDisc& disc, double radius, const OcclusionTest& occlusion) {
  constexpr double kMostEmpty = 0.3;
  const Vec3 way = disc.center - tip;
  double empty = 0.0, places = 0.0;
  for (double along = 0.5 * radius; along < way.norm() - radius; along += 0.5 * radius, ++places)
    empty += occlusion.around(tip + along * way.normalized(), way).empty;
  return empty > kMostEmpty * places;
}

/// The path's last end leads to the disc, by a cylinder that nothing shows and one behind the disc.
void lead_to(const EndDisc& disc, TubeModel& tube, TubePath& path) {
  constexpr double kOdds = 2.3;  // nats: of 33 discs in 293 simulated clouds 30 were the tubes' that lead to them
  const double depth = std::min(tube.radius, 0.5 * (disc.center - path.nodes.back()).norm());
  path.nodes.insert(path.nodes.end(), {disc.center - depth * disc.outward, disc.center});
  path.bridged.insert(path.bridged.end(), {true, false});
  path.bridge_odds.push_back(kOdds);
  if (tube.whole_odds) tube.whole_odds = std::min(*tube.whole_odds, kOdds);
}

/// Whether a tube may go on from the end to the disc, by `longest_way` metres at most.
bool is_reachable(const EndDisc& disc, const PathEnd& end, double radius, double longest_way,
                  const OcclusionTest& occlusion) {
  constexpr double kMostTurn = 1.0;  // radians
  const double way = (disc.center - end.tip).norm();
  return way <= std::min(kFarthest * radius, longest_way) && turn_to(disc, end, radius) <= kMostTurn &&
         !is_seen_through(end.tip, disc, radius, occlusion);
}

/// Leads paths to discs, those first that turn least: each disc is one path's, and each end of a path reaches one. True if any does.
bool reach_by_least_turn(std::vector<ReachableDisc> reachable) {
  std::ranges::stable_sort(reachable, {}, &ReachableDisc::turn);
  std::vector<Vec3> reached;
  std::set<std::pair<const TubePath*, bool>> ends;
  for (const auto& [tube, path, is_last, disc, turn] : reachable) {
    if (!within(disc.center, tube->radius, reached).empty() || !ends.emplace(path, is_last).second) continue;
    reached.push_back(disc.center);
    if (!is_last) turn_about(*path);
    lead_to(disc, *tube, *path);
    if (!is_last) turn_about(*path);
  }
  return !reached.empty();
}

}  // namespace

std::vector<EndDisc> find_end_discs(std::span<const Vec3> points, double radius, double spacing,
                                    const Vec3& viewpoint) {
  constexpr std::size_t kTries = 40;
  constexpr double kLeastPart = 0.25, kGoesOn = 0.1;
  constexpr double kWide = 1.2, kThick = 0.05;  // radii
  std::vector<EndDisc> discs;
  for (std::size_t i = 0; i < points.size(); i += points.size() / kTries + 1) {
    if (std::ranges::any_of(discs, [&](const EndDisc& d) { return (d.center - points[i]).norm() < kWide * radius; }))
      continue;
    std::vector<Vec3> disc = within(points[i], 0.5 * radius, points);
    if (disc.size() < kFewPoints) continue;
    FittedPlane plane = plane_of(disc);
    if (std::sqrt(plane.mean_square) > kThick * radius) continue;
    for (int round = 0; round < 4 && disc.size() >= kFewPoints; ++round) {
      disc = on_plane(plane, radius, kWide * radius, points);
      if (!disc.empty()) plane = plane_of(disc);
    }
    const double facing = plane.normal.dot((viewpoint - plane.center).normalized());
    const double full = points_of_flat_end(radius, spacing) * std::abs(facing);
    const auto count = static_cast<double>(disc.size());
    const auto around = static_cast<double>(on_plane(plane, radius, kAround * radius, points).size());
    if (disc.size() < kFewPoints || facing == 0.0 || count < kLeastPart * full || around > (1.0 + kGoesOn) * count)
      continue;
    discs.push_back({.center = plane.center, .outward = std::copysign(1.0, facing) * plane.normal});
  }
  return discs;
}

bool reach_end_discs(std::vector<TubeModel>& tubes, const FilteredCloud& cloud, const std::vector<cloud::Label>& labels,
                     const ViewProjection& projection, const OcclusionTest& scan, const std::vector<double>& lengths) {
  const auto reach = [](const TubeModel& tube) { return (kFarthest + kAround) * tube.radius; };
  const Segment unlabeled = about_ends(tubes, cloud.points, points_without_label(labels), reach);
  std::vector<ReachableDisc> reachable;
  for (TubeModel& tube : tubes) {
    const OcclusionTest occlusion = scan.with_radius(tube.radius);
    const double longest_way = lengths.empty() ? kFarthest * tube.radius : lengths.back() + tube.radius - tube.length();
    for (TubePath& path : tube.paths)
      for (int end = 0; end < 2 && path.nodes.size() > 1; ++end) {
        turn_about(path);
        const PathEnd last = last_end(path.nodes, tube.radius);
        const Segment beyond = near(last.tip, reach(tube), cloud.points, unlabeled);
        for (const EndDisc& disc : find_end_discs(positions_at(cloud.points, beyond), tube.radius, cloud.spacing,
                                                  viewpoint_of(cloud, beyond, projection)))
          if (is_reachable(disc, last, tube.radius, longest_way, occlusion))
            reachable.push_back({.tube = &tube,
                                 .path = &path,
                                 .is_last = end == 1,
                                 .disc = disc,
                                 .turn = turn_to(disc, last, tube.radius)});
      }
  }
  return reach_by_least_turn(std::move(reachable));
}

}  // namespace tubebin::modeling
