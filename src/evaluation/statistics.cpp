#include "evaluation/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tubebin/core/random.hpp"

namespace tubebin::evaluation {
namespace {

std::vector<double> ranks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> rank(values.size());
  for (std::size_t start = 0; start < order.size();) {
    std::size_t end = start;
    while (end < order.size() && values[order[end]] == values[order[start]]) ++end;
    for (std::size_t i = start; i < end; ++i) rank[order[i]] = 0.5 * static_cast<double>(start + end - 1);
    start = end;
  }
  return rank;
}

struct Moments {
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
};

Moments central_moments(std::span<const double> x, std::span<const double> y) {
  const double mean_x = mean(x);
  const double mean_y = mean(y);
  Moments moments;
  for (std::size_t i = 0; i < x.size(); ++i) {
    moments.xx += (x[i] - mean_x) * (x[i] - mean_x);
    moments.xy += (x[i] - mean_x) * (y[i] - mean_y);
    moments.yy += (y[i] - mean_y) * (y[i] - mean_y);
  }
  return moments;
}

}  // namespace

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

LineFit fit_line(std::span<const double> x, std::span<const double> y) {
  const Moments m = central_moments(x, y);
  if (m.xx <= 0.0) return {};
  return {m.xy / m.xx, m.yy > 0.0 ? m.xy * m.xy / (m.xx * m.yy) : 1.0};
}

double rank_correlation(std::span<const double> x, std::span<const double> y) {
  const std::vector<double> rank_x = ranks(x);
  const std::vector<double> rank_y = ranks(y);
  const Moments m = central_moments(rank_x, rank_y);
  return m.xx > 0.0 && m.yy > 0.0 ? m.xy / std::sqrt(m.xx * m.yy) : 0.0;
}

Interval bootstrap_of_means(const std::vector<std::vector<double>>& groups,
                            const std::function<double(std::span<const double> means)>& statistic, std::uint64_t seed) {
  std::vector<double> means;
  for (const std::vector<double>& group : groups) means.push_back(mean(group));
  Interval interval;
  interval.mean = statistic(means);
  Random random(seed);
  std::vector<double> values(kBootstrapResamples);
  for (double& value : values) {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const auto size = static_cast<double>(groups[g].size());
      double sum = 0.0;
      for (std::size_t i = 0; i < groups[g].size(); ++i)
        sum += groups[g][static_cast<std::size_t>(random.uniform(0.0, size))];
      means[g] = sum / size;
    }
    value = statistic(means);
  }
  std::sort(values.begin(), values.end());
  interval.low = values[static_cast<std::size_t>(std::lround(0.025 * (kBootstrapResamples - 1)))];
  interval.high = values[static_cast<std::size_t>(std::lround(0.975 * (kBootstrapResamples - 1)))];
  return interval;
}

}  // namespace tubebin::evaluation
