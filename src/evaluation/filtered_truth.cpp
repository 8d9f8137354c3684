#include "tubebin/evaluation/filtered_truth.hpp"

#include <map>

#include "evaluation/position_index.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::evaluation {
namespace {

// Of so many points chance leaves out all but a twentieth of the lowest ratio's part in less than one of 10,000 scenes.
constexpr std::size_t kManyPoints = 500;

using PointCounts = std::map<cloud::Label, std::size_t>;

/// Points of each tube; without those of the bin.
PointCounts count_tube_points(const cloud::Cloud& cloud) {
  PointCounts counts;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.labels[i] != 0 && cloud::is_finite(cloud.points[i])) ++counts[cloud.labels[i]];
  return counts;
}

double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 1.0;
}

/// Returns the share of all tubes' points.
double require_coverage(const PointCounts& of_scene, PointCounts of_part, const NamedCloud& filtered) {
  std::size_t part = 0, whole = 0;
  const auto require = [&](double share, const std::string& what) {
    if (share < kCoverageMin)
      throw_io_error(
          "{}: has {:.2f} % of the scene's points of {}; valid: at least {} %, so that a score says something "
          "about the scene",
          filtered.name, share * 100.0, what, kCoverageMin * 100.0);
  };
  for (const auto& [label, points] : of_scene) {
    part += of_part[label];
    whole += points;
    if (points >= kManyPoints) require(share(of_part[label], points), fmt::format("tube {}", label));
  }
  require(share(part, whole), "tubes");
  return share(part, whole);
}

}  // namespace

FilteredTruth filtered_truth(const NamedCloud& scene, const NamedCloud& filtered) {
  const std::vector<std::uint32_t> point_of =
      corresponding_points(filtered.cloud.points, scene.cloud.points, kPositionTolerance);
  FilteredTruth truth;
  truth.cloud.points = filtered.cloud.points;
  truth.cloud.width = filtered.cloud.width;
  truth.cloud.height = filtered.cloud.height;
  truth.cloud.labels.assign(filtered.cloud.size(), 0);
  for (std::size_t i = 0; i < point_of.size(); ++i) {
    if (point_of[i] != kNoPoint) {
      truth.cloud.labels[i] = scene.cloud.labels[point_of[i]];
    } else if (cloud::is_finite(filtered.cloud.points[i])) {
      const cloud::Point& p = filtered.cloud.points[i];
      throw_io_error(
          "{}: its point {} at {} {} {} m is at no point of {}; a filtered cloud has points of the scene alone",
          filtered.name, i, p.x(), p.y(), p.z(), scene.name);
    }
  }
  truth.coverage = require_coverage(count_tube_points(scene.cloud), count_tube_points(truth.cloud), filtered);
  return truth;
}

}  // namespace tubebin::evaluation
