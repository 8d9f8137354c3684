#include "modeling/doubtful_tubes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include "modeling/fitting/piece_evidence.hpp"

namespace tubebin::modeling {
namespace {

/// Of the evidence that a point of tubes of that radius has on average. A tube seen from the side still has a tenth of it a point,
/// a nearly hidden one 0.1 to 2.6 %; a fold of a liner up to 1.3 %, a short bit of rough ground 6.2 %.
double least_share(const TubeModel& tube, bool is_rough) {
  return is_rough && tube.length() < kShort * tube.radius ? 0.08 : 0.025;
}

struct PointEvidence {
  double evidence = 0.0, points = 0.0;
};

std::vector<PointEvidence> point_evidence(const std::vector<TubeModel>& tubes,
                                          const std::vector<cloud::Label>& labels) {
  std::vector<PointEvidence> found(tubes.size());
  for (std::size_t t = 0; t < tubes.size(); ++t)
    for (const TubePath& path : tubes[t].paths) found[t].evidence += path.evidence;
  for (const cloud::Label label : labels)
    if (label > 0) found[label - 1].points += 1.0;
  return found;
}

std::vector<std::uint32_t> points_of(std::size_t tube, const std::vector<cloud::Label>& labels) {
  std::vector<std::uint32_t> points;
  for (std::uint32_t i = 0; i < labels.size(); ++i)
    if (labels[i] == tube + 1) points.push_back(i);
  return points;
}

/// Whether one of the tubes is as long, to a radius.
bool has_length(const std::vector<TubeModel>& tubes, double length) {
  return std::ranges::any_of(tubes,
                             [&](const TubeModel& tube) { return std::abs(tube.length() - length) < tube.radius; });
}

/// Takes the lengths out that only the dropped had.
void erase_lengths(std::vector<double>& lengths, const std::vector<TubeModel>& dropped,
                   const std::vector<TubeModel>& tubes) {
  std::erase_if(lengths, [&](double length) { return has_length(dropped, length) && !has_length(tubes, length); });
}

}  // namespace

std::vector<WeakTube> drop_doubtful(std::vector<TubeModel>& tubes, std::vector<double>& lengths,
                                    const std::vector<cloud::Label>& labels, bool is_rough) {
  const std::vector<PointEvidence> found = point_evidence(tubes, labels);
  std::map<double, PointEvidence> of_radius;
  for (std::size_t t = 0; t < tubes.size(); ++t) {
    PointEvidence& all = of_radius[tubes[t].radius];
    all.evidence += found[t].evidence;
    all.points += found[t].points;
  }
  std::vector<TubeModel> kept, dropped;
  std::vector<WeakTube> weak;
  for (std::size_t t = 0; t < tubes.size(); ++t) {
    const auto& [evidence, points] = found[t];
    const PointEvidence& all = of_radius[tubes[t].radius];
    const bool is_weak = evidence * all.points < least_share(tubes[t], is_rough) * points * all.evidence;
    // Of other things than ground, a weak one says half a nat a point at most; a nearly hidden tube more than one.
    const bool is_none = is_weak && (is_rough || evidence < points);
    const bool goes = is_none || is_doubtful(tubes[t].length(), tubes[t].radius, evidence);
    if (goes) dropped.push_back(std::move(tubes[t]));
    else if (is_weak) weak.push_back({.tube = std::move(tubes[t]), .points = points_of(t, labels)});
    else kept.push_back(std::move(tubes[t]));
  }
  tubes = std::move(kept);
  erase_lengths(lengths, dropped, tubes);
  return weak;
}

bool restore_unexplained(const std::vector<WeakTube>& weak, std::vector<TubeModel>& tubes, std::vector<double>& lengths,
                         const std::vector<cloud::Label>& labels) {
  const std::size_t before = tubes.size();
  std::vector<TubeModel> dropped;
  for (const auto& [tube, points] : weak) {
    const auto left = std::ranges::count_if(points, [&](std::uint32_t i) { return labels[i] == 0; });
    const bool is_explained = 2 * static_cast<std::size_t>(left) <= points.size();
    (is_explained ? dropped : tubes).push_back(tube);
  }
  erase_lengths(lengths, dropped, tubes);
  return tubes.size() > before;
}

}  // namespace tubebin::modeling
