#include "modeling/joining/sampled_curve.hpp"

#include <algorithm>
#include <cmath>

#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {
namespace {

std::vector<Vec3> samples_of(const std::vector<Vec3>& nodes, double step) {
  const double length = polyline_length(nodes);
  const auto steps = static_cast<std::size_t>(std::max(std::round(length / step), 1.0));
  std::vector<Vec3> samples;
  double passed = 0.0;
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const Vec3 along = nodes[k + 1] - nodes[k];
    for (; samples.size() < steps;) {
      const double ahead = length * static_cast<double>(samples.size()) / static_cast<double>(steps) - passed;
      if (ahead > along.norm()) break;
      samples.push_back(nodes[k] + ahead / std::max(along.norm(), 1e-12) * along);
    }
    passed += along.norm();
  }
  samples.push_back(nodes.back());
  return samples;
}

}  // namespace

std::vector<Vec3> smooth_samples(const std::vector<Vec3>& nodes, double step, double reach) {
  const std::vector<Vec3> fine = samples_of(nodes, step / 2.0);
  const auto most = static_cast<std::size_t>(std::round(2.0 * reach / step));
  std::vector<Vec3> means;
  for (std::size_t k = 0; k < fine.size(); ++k) {
    const std::size_t around = std::min({most, k, fine.size() - 1 - k});
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = k - around; i <= k + around; ++i) sum += fine[i];
    means.push_back(sum / static_cast<double>(2 * around + 1));
  }
  return samples_of(means, step);  // the means are nearer to each other than what they are of
}

double sagitta(std::span<const Vec3> samples) {
  const std::vector<Vec3> chord = {samples.front(), samples.back()};
  double farthest = 0.0;
  for (const Vec3& place : samples) farthest = std::max(farthest, distance_to_polyline(place, chord));
  return farthest;
}

Pose best_motion(std::span<const Vec3> from, std::span<const Vec3> to) {
  const auto count = static_cast<Eigen::Index>(from.size());
  const Eigen::Map<const Eigen::Matrix3Xd> a(from.front().data(), 3, count), b(to.front().data(), 3, count);
  return Pose(Eigen::umeyama(a, b, false));
}

double mean_squared_distance(std::span<const Vec3> from, std::span<const Vec3> to, const Pose& motion) {
  double squares = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) squares += (motion * from[k] - to[k]).squaredNorm();
  return squares / static_cast<double>(from.size());
}

double distance_apart(std::span<const Vec3> from, std::span<const Vec3> to, std::ptrdiff_t first, Pose motion) {
  constexpr int kMostRounds = 8;
  constexpr std::ptrdiff_t kReach = 8;  // samples along the polyline that a place may be off by
  const auto last = static_cast<std::ptrdiff_t>(to.size()) - 1;
  const auto part_about = [&](std::size_t k) {
    const std::ptrdiff_t place = first + static_cast<std::ptrdiff_t>(k);
    const std::ptrdiff_t begin = std::clamp<std::ptrdiff_t>(place - kReach, 0, last);
    const std::ptrdiff_t end = std::clamp<std::ptrdiff_t>(place + kReach, 0, last);
    return to.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin) + 1);
  };
  double squares = 0.0;
  std::vector<Vec3> nearest(from.size());
  for (int round = 0; round < kMostRounds; ++round) {
    const double before = squares;
    squares = 0.0;
    for (std::size_t k = 0; k < from.size(); ++k) {
      const Vec3 place = motion * from[k];
      nearest[k] = nearest_on_polyline(place, part_about(k));
      squares += (place - nearest[k]).squaredNorm();
    }
    if (round > 0 && squares > 0.9 * before) break;
    motion = best_motion(from, nearest);
  }
  return std::sqrt(squares / static_cast<double>(from.size()));
}

}  // namespace tubebin::modeling
