#include "modeling/doubtful_tubes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include "modeling/fitting/piece_evidence.hpp"

namespace tubebin::modeling {
namespace {

/// Of the evidence that a point of tubes of that radius has on average. A tube seen from the side still has a tenth of it a point,
/// a partly hidden one 2.6 %; a crease or an edge, which is round in few places, up to 2.3 %, a short bit of rough ground 6.2 %.
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

/// Whether one of the tubes is as long, to a radius.
bool has_length(const std::vector<TubeModel>& tubes, double length) {
  return std::ranges::any_of(tubes,
                             [&](const TubeModel& tube) { return std::abs(tube.length() - length) < tube.radius; });
}

}  // namespace

bool drop_doubtful(std::vector<TubeModel>& tubes, std::vector<double>& lengths, const std::vector<cloud::Label>& labels,
                   bool is_rough) {
  const std::vector<PointEvidence> found = point_evidence(tubes, labels);
  std::map<double, PointEvidence> of_radius;
  for (std::size_t t = 0; t < tubes.size(); ++t) {
    PointEvidence& all = of_radius[tubes[t].radius];
    all.evidence += found[t].evidence;
    all.points += found[t].points;
  }
  std::vector<TubeModel> kept, dropped;
  for (std::size_t t = 0; t < tubes.size(); ++t) {
    const auto& [evidence, points] = found[t];
    const PointEvidence& all = of_radius[tubes[t].radius];
    const bool is_weak = evidence * all.points < least_share(tubes[t], is_rough) * points * all.evidence;
    const bool goes = is_weak || is_doubtful(tubes[t].length(), tubes[t].radius, evidence);
    (goes ? dropped : kept).push_back(std::move(tubes[t]));
  }
  tubes = std::move(kept);
  std::erase_if(lengths, [&](double length) { return has_length(dropped, length) && !has_length(tubes, length); });
  return !dropped.empty();
}

}  // namespace tubebin::modeling
