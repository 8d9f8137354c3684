#include "tubebin/evaluation/centerline.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tubebin::evaluation {
namespace {

std::vector<Vec3> sample_segment(const CenterlineSegment& segment) {
  const double length = (segment.end - segment.start).norm();
  const int steps = std::max(1, static_cast<int>(std::ceil(length / kCenterlineStep)));
  std::vector<Vec3> samples;
  // Midpoints of equal parts weigh every stretch by its length, and joints are not counted twice.
  for (int i = 0; i < steps; ++i)
    samples.push_back(segment.start + (segment.end - segment.start) * ((i + 0.5) / steps));
  return samples;
}

double squared_distance(const Vec3& point, const CenterlineSegment& segment) {
  const Vec3 along = segment.end - segment.start;
  const double squared_length = along.squaredNorm();
  const double t =
      squared_length > 0.0 ? std::clamp((point - segment.start).dot(along) / squared_length, 0.0, 1.0) : 0.0;
  return (point - segment.start - t * along).squaredNorm();
}

double distance(const Vec3& point, const Centerline& line) {
  double nearest = std::numeric_limits<double>::max();
  for (const CenterlineSegment& segment : line) nearest = std::min(nearest, squared_distance(point, segment));
  return std::sqrt(nearest);
}

/// Squared distance between the segments p + s d (0 <= s <= 1) and a segment (Ericson 2005, Section 5.1.9).
double squared_distance(const Vec3& p, const Vec3& d, const CenterlineSegment& segment) {
  const Vec3 e = segment.end - segment.start;
  const Vec3 r = p - segment.start;
  const double dd = d.squaredNorm();
  const double ee = e.squaredNorm();
  const double de = d.dot(e);
  const double dr = d.dot(r);
  const double er = e.dot(r);
  const double denominator = dd * ee - de * de;
  double s = denominator > 0.0 ? std::clamp((de * er - dr * ee) / denominator, 0.0, 1.0) : 0.0;
  const double t = ee > 0.0 ? std::clamp((de * s + er) / ee, 0.0, 1.0) : 0.0;
  s = dd > 0.0 ? std::clamp((de * t - dr) / dd, 0.0, 1.0) : 0.0;
  return (r + s * d - t * e).squaredNorm();
}

/// Whether the tube crosses the line of sight from the scanner to the target.
bool occludes(const Centerline& line, double radius, const Vec3& scanner, const Vec3& target) {
  const Vec3 sight = target - scanner;
  const double inverse_length = 1.0 / sight.norm();
  return std::any_of(line.begin(), line.end(), [&](const CenterlineSegment& segment) {
    // Most segments are far from the line of sight: a sphere around the segment tells.
    const Vec3 middle = 0.5 * (segment.start + segment.end);
    const double reach = 0.5 * (segment.end - segment.start).norm() + radius;
    if ((middle - scanner).cross(sight).norm() * inverse_length > reach) return false;
    return squared_distance(scanner, sight, segment) < radius * radius;
  });
}

struct MeanAndP95 {
  double mean = 0.0;
  double p95 = 0.0;
};

MeanAndP95 summarize(std::vector<double>& distances) {
  if (distances.empty()) return {};
  const double sum = std::accumulate(distances.begin(), distances.end(), 0.0);
  // Nearest rank.
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(0.95 * static_cast<double>(distances.size()))) - 1;
  std::nth_element(distances.begin(), distances.begin() + rank, distances.end());
  return {sum / static_cast<double>(distances.size()), distances[static_cast<std::size_t>(rank)]};
}

}  // namespace

double CenterlineSamples::visible_fraction() const {
  if (visible.empty()) return 0.0;
  return static_cast<double>(std::count(visible.begin(), visible.end(), char{1})) / static_cast<double>(visible.size());
}

Centerline centerline(const scene::PlacedTube& tube) {
  Centerline line;
  for (const tube::Cylinder& cylinder : tube.tube.cylinders)
    line.push_back({tube.node_in_world(cylinder.node_a), tube.node_in_world(cylinder.node_b)});
  // A node alone is a sphere: a segment of no length.
  if (line.empty() && !tube.tube.nodes.empty()) line.push_back({tube.node_in_world(0), tube.node_in_world(0)});
  return line;
}

std::vector<TubeLine> tube_lines(const scene::Scene& scene) {
  std::vector<TubeLine> axes;
  for (const scene::PlacedTube& tube : scene.tubes) axes.push_back({centerline(tube), tube.tube.radius, {}});
  return axes;
}

std::vector<CenterlineSamples> sample_centerlines(const scene::Scene& scene) {
  std::vector<Vec3> scanners = {scene.scanner.position};
  for (const scene::Scanner& scanner : scene.further_scanners) scanners.push_back(scanner.position);
  std::vector<Centerline> lines;
  for (const scene::PlacedTube& tube : scene.tubes) lines.push_back(centerline(tube));
  std::vector<CenterlineSamples> result(lines.size());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    for (const CenterlineSegment& segment : lines[k]) {
      for (const Vec3& point : sample_segment(segment)) {
        const bool visible = std::ranges::any_of(scanners, [&](const Vec3& scanner) {
          for (std::size_t other = 0; other < lines.size(); ++other)
            if (other != k && occludes(lines[other], scene.tubes[other].tube.radius, scanner, point)) return false;
          return true;
        });
        result[k].points.push_back(point);
        result[k].visible.push_back(visible ? 1 : 0);
      }
    }
  }
  return result;
}

CenterlineError centerline_error(const Centerline& truth, const CenterlineSamples& truth_samples,
                                 const Centerline& model) {
  std::vector<double> from_model;
  for (const CenterlineSegment& segment : model) {
    if (segment.bridged) continue;
    for (const Vec3& point : sample_segment(segment)) from_model.push_back(distance(point, truth));
  }
  std::vector<double> from_truth;
  for (std::size_t i = 0; i < truth_samples.points.size(); ++i)
    if (truth_samples.visible[i]) from_truth.push_back(distance(truth_samples.points[i], model));

  CenterlineError error;
  error.model_samples = static_cast<int>(from_model.size());
  error.truth_samples = static_cast<int>(from_truth.size());
  const MeanAndP95 model_summary = summarize(from_model);
  const MeanAndP95 truth_summary = summarize(from_truth);
  error.model_mean = model_summary.mean;
  error.model_p95 = model_summary.p95;
  error.truth_mean = truth_summary.mean;
  error.truth_p95 = truth_summary.p95;
  return error;
}

}  // namespace tubebin::evaluation
