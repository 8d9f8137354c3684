#include "modeling/joining/length_model.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace tubebin::modeling {
namespace {

/// A tube shorter than it should be can have other reasons than a missed join (a stretch too narrow to segment, a
/// length that is not common to all), one that is longer other reasons than a wrong join (an end that is drawn out
/// beyond a flat end): e^-10.
constexpr double kLengthCostLimit = 10.0;
/// Where an end is out of sight, it may go on another way than it seems to: e^-6.
constexpr double kHiddenLengthCostLimit = 6.0;
/// What may be no tube and what no tube explains is as likely chance as not: e^-3.
constexpr double kChanceCostLimit = 3.0;
constexpr std::size_t kPossibleLengths = 4;
/// Before the scan tells: a bin holds one kind of tube ten times as often as any.
constexpr double kOddsOfOneLength = 10.0;

}  // namespace

/// Ends are placed to a fraction of a radius, and a bridge's true course may be a twentieth longer.
double LengthModel::sigma(double bridged) const {
  return std::sqrt(radius * radius / 16.0 + bridged * bridged / 400.0);
}

double LengthModel::longest() const {
  const double length = common.empty() ? longest_likely : std::ranges::max(common);
  return length + 5.0 * sigma(length / 4.0);
}

double LengthModel::cost(double length, double bridged, double room, bool may_be_chance) const {
  double least = common.empty() ? 0.0 : std::numeric_limits<double>::infinity();
  for (const double one : common) least = std::min(least, cost_beside(one, length, bridged, room, may_be_chance));
  return least;
}

double LengthModel::cost_beside(double one, double length, double bridged, double room, bool may_be_chance) const {
  const double missing = one - length;
  const double unexplained = missing < 0.0 ? missing : std::max(missing - room, 0.0);
  double limit = kLengthCostLimit;
  if (missing >= 0.0 && room > 0.0) limit = kHiddenLengthCostLimit;
  if (missing >= 0.0 && may_be_chance) limit = kChanceCostLimit;
  return std::min(0.5 * unexplained * unexplained / (sigma(bridged) * sigma(bridged)), limit);
}

double LengthModel::gain(double length, double bridged, double room) const {
  double most = 0.0;
  for (const double one : common)
    most = std::max(most, gain_beside(one, length, bridged, room) - std::log(static_cast<double>(common.size())));
  return most;
}

double LengthModel::gain_beside(double one, double length, double bridged, double room) const {
  const double any = std::max(longest_likely, one);
  if (std::abs(length - one) <= 2.0 * sigma(bridged))
    return std::log(any / (std::sqrt(2.0 * std::numbers::pi) * sigma(bridged)));
  return length < one && one < length + room ? std::log(any / one) : 0.0;
}

double LengthModel::cost_of_common_lengths() const {
  double cost = common.size() == 1 ? -std::log(kOddsOfOneLength) : 0.0;
  for (const double one : common)
    cost += gain_beside(one, one, 0.0, 0.0) + std::log(static_cast<double>(kPossibleLengths));
  return cost;
}

std::vector<double> LengthModel::possible_common(std::vector<double> seen) const {
  std::sort(seen.begin(), seen.end());
  const double tolerance = 4.0 * sigma(0.0);
  std::vector<std::pair<double, double>> of_support;
  for (std::size_t first = 0; first < seen.size(); ++first) {
    std::size_t last = first;
    double sum = 0.0;
    while (last < seen.size() && seen[last] <= seen[first] + tolerance) sum += seen[last++];
    of_support.emplace_back(sum, seen[first + (last - first) / 2]);
  }
  std::sort(of_support.begin(), of_support.end(), std::greater<>());
  std::vector<double> lengths;
  for (const auto& each : of_support) {
    const double length = each.second;
    const auto is_same = [&](double other) { return std::abs(other - length) <= tolerance; };
    if (lengths.size() < kPossibleLengths && std::ranges::none_of(lengths, is_same)) lengths.push_back(length);
  }
  return lengths;
}

std::vector<double> LengthModel::recurring(std::vector<double> seen) const {
  std::sort(seen.begin(), seen.end());
  const double tolerance = 4.0 * sigma(0.0);
  std::vector<double> lengths;
  for (std::size_t first = 0, last = 0; first < seen.size(); first = last) {
    while (last < seen.size() && seen[last] <= seen[first] + tolerance) ++last;
    if (last - first > 1) lengths.push_back(seen[first + (last - first) / 2]);
  }
  return lengths.size() > 1 && lengths.size() <= kPossibleLengths ? lengths : std::vector<double>{};
}

}  // namespace tubebin::modeling
