#include "tubebin/calibration/parameter_search.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "tubebin/core/shuffle.hpp"

namespace tubebin::calibration {
namespace {

/// Of the budget, for halving; the rest is for the compass search.
constexpr double kHalvingShare = 0.5;
/// A third of the settings goes on to three times the runs.
constexpr std::size_t kHalvingFactor = 3;
constexpr std::size_t kRungs = 3;
/// Of a range: the first step of the compass search, and the one below which it ends.
constexpr double kFirstStep = 0.15;
constexpr double kLastStep = 0.01;

double round_to_digits(double value) {
  constexpr int kDigits = 3;
  if (value == 0.0) return 0.0;
  const int exponent = kDigits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value))));
  // Dividing by a whole power of ten gives the decimal's nearest double, multiplying by its inverse does not.
  const double power = std::pow(10.0, std::abs(exponent));
  return exponent >= 0 ? std::round(value * power) / power : std::round(value / power) * power;
}

std::vector<std::size_t> shuffled(std::size_t count, Random& random) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  shuffle(order, random);
  return order;
}

class Search {
 public:
  Search(const std::vector<SearchRange>& ranges, const Setting& start, const SearchOptions& options,
         const ScoreSettings& score)
      : ranges_(ranges), start_(start), options_(options), score_(score), random_(options.seed) {}

  SearchResult run() {
    halve();
    follow_compass();
    result_.setting_count = runs_of_.size();
    return result_;
  }

 private:
  /// Runs of each rung: a ninth, a third, all of them.
  std::vector<std::size_t> rungs() const {
    std::vector<std::size_t> counts = {options_.run_count};
    while (counts.size() < kRungs && counts.front() > 1)
      counts.insert(counts.begin(), (counts.front() + kHalvingFactor - 1) / kHalvingFactor);
    return counts;
  }

  /// As many settings beside the start, which is scored on all runs, as halving's part of the budget lets begin.
  std::size_t first_count(const std::vector<std::size_t>& rungs) const {
    double runs_a_setting = 0.0, survivors = 1.0;
    for (std::size_t k = 0; k < rungs.size(); ++k) {
      runs_a_setting += survivors * static_cast<double>(rungs[k] - (k > 0 ? rungs[k - 1] : 0));
      survivors /= kHalvingFactor;
    }
    const double runs = (kHalvingShare * options_.budget - 1.0) * static_cast<double>(options_.run_count);
    return static_cast<std::size_t>(std::max(0.0, runs / runs_a_setting));
  }

  /// Latin hypercube (McKay, Beckman and Conover 1979): along each parameter, one setting in each of `count` slices.
  std::vector<Setting> spread_settings(std::size_t count) {
    std::vector<Setting> settings(count, Setting(ranges_.size()));
    for (std::size_t p = 0; p < ranges_.size(); ++p) {
      const std::vector<std::size_t> slices = shuffled(count, random_);
      for (std::size_t i = 0; i < count; ++i)
        settings[i][p] = ranges_[p].value_at((static_cast<double>(slices[i]) + random_.uniform(0.0, 1.0)) /
                                             static_cast<double>(count));
    }
    return settings;
  }

  void halve() {
    const std::vector<std::size_t> counts = rungs();
    std::vector<Setting> settings = spread_settings(first_count(counts));
    settings.insert(settings.begin(), start_);
    std::vector<double> scores;
    for (const std::size_t run_count : counts) {
      if (!scores.empty()) settings = best_third(settings, scores);
      scores = score(settings, run_count);
    }
    const auto best = std::max_element(scores.begin(), scores.end()) - scores.begin();
    result_.start_score = scores.front();
    move_to(settings[static_cast<std::size_t>(best)], scores[static_cast<std::size_t>(best)]);
  }

  /// The start, which is first, and the best third of the others.
  static std::vector<Setting> best_third(const std::vector<Setting>& settings, const std::vector<double>& scores) {
    std::vector<std::size_t> others(settings.size() - 1);
    std::iota(others.begin(), others.end(), std::size_t{1});
    std::ranges::stable_sort(others, std::greater(), [&](std::size_t i) { return scores[i]; });
    others.resize((others.size() + kHalvingFactor - 1) / kHalvingFactor);
    std::vector<Setting> best = {settings.front()};
    for (const std::size_t i : others) best.push_back(settings[i]);
    return best;
  }

  /// Up and down along one parameter after the other. A parameter's step is halved where neither is better.
  void follow_compass() {
    std::vector<double> steps(ranges_.size(), kFirstStep);
    while (std::any_of(steps.begin(), steps.end(), [](double step) { return step >= kLastStep; }))
      for (std::size_t p = 0; p < ranges_.size(); ++p) {
        if (steps[p] < kLastStep) continue;
        const std::vector<Setting> neighbours = neighbours_along(p, steps[p]);
        if (!affordable(neighbours)) return;
        if (!move_to_better(neighbours)) steps[p] /= 2.0;
      }
  }

  std::vector<Setting> neighbours_along(std::size_t p, double step) const {
    std::vector<Setting> neighbours;
    for (const double sign : {1.0, -1.0}) {
      Setting neighbour = result_.best;
      const double value = neighbour[p];
      neighbour[p] = ranges_[p].value_at(ranges_[p].place_of(value) + sign * step);
      if (neighbour[p] != value) neighbours.push_back(neighbour);
    }
    return neighbours;
  }

  bool affordable(const std::vector<Setting>& settings) const {
    const std::size_t runs = result_.scored_runs + unscored_runs(settings, options_.run_count);
    return static_cast<double>(runs) <= options_.budget * static_cast<double>(options_.run_count);
  }

  bool move_to_better(const std::vector<Setting>& settings) {
    if (settings.empty()) return false;
    const std::vector<double> scores = score(settings, options_.run_count);
    const auto best = std::max_element(scores.begin(), scores.end());
    if (*best <= result_.score) return false;
    move_to(settings[static_cast<std::size_t>(best - scores.begin())], *best);
    return true;
  }

  void move_to(const Setting& setting, double score) {
    result_.best = setting;
    result_.score = score;
  }

  std::size_t unscored_runs(const std::vector<Setting>& settings, std::size_t run_count) const {
    std::size_t runs = 0;
    for (const Setting& setting : settings) {
      const auto scored = runs_of_.find(setting);
      runs += run_count - std::min(run_count, scored == runs_of_.end() ? 0 : scored->second);
    }
    return runs;
  }

  std::vector<double> score(const std::vector<Setting>& settings, std::size_t run_count) {
    result_.scored_runs += unscored_runs(settings, run_count);
    for (const Setting& setting : settings) runs_of_[setting] = std::max(runs_of_[setting], run_count);
    return score_(settings, run_count);
  }

  const std::vector<SearchRange>& ranges_;
  const Setting& start_;
  const SearchOptions& options_;
  const ScoreSettings& score_;
  Random random_;
  std::map<Setting, std::size_t> runs_of_;  // on how many runs a setting has been scored
  SearchResult result_;
};

}  // namespace

double SearchRange::value_at(double place) const {
  const double inside = std::clamp(place, 0.0, 1.0);
  const double value = logarithmic ? low * std::pow(high / low, inside) : low + (high - low) * inside;
  return std::clamp(whole ? std::round(value) : round_to_digits(value), low, high);
}

double SearchRange::place_of(double value) const {
  if (!(high > low)) return 0.0;
  const double inside = std::clamp(value, low, high);
  return logarithmic ? std::log(inside / low) / std::log(high / low) : (inside - low) / (high - low);
}

SearchResult search_parameters(const std::vector<SearchRange>& ranges, const Setting& start,
                               const SearchOptions& options, const ScoreSettings& score) {
  return Search(ranges, start, options, score).run();
}

}  // namespace tubebin::calibration
