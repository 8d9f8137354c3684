// The search of calibrate_modeler on functions whose best settings are known.
#include "tubebin/calibration/parameter_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace tubebin::calibration {
namespace {

const std::vector<SearchRange> kRanges = {{.low = -2.0, .high = 3.0},
                                          {.low = 0.001, .high = 1.0, .logarithmic = true},
                                          {.low = 1, .high = 50, .logarithmic = true, .whole = true},
                                          {.low = 0, .high = 9, .whole = true}};
const Setting kBest = {1.25, 0.02, 12, 7};
const Setting kStart = {-1.0, 0.5, 2, 1};

/// One minus the squared distance from the best setting, in parts of the ranges.
double bowl(const Setting& setting) {
  double score = 1.0;
  for (std::size_t p = 0; p < kRanges.size(); ++p)
    score -= std::pow(kRanges[p].place_of(setting[p]) - kRanges[p].place_of(kBest[p]), 2);
  return score;
}

/// Scores, and keeps how many runs of each setting were asked for.
struct Counter {
  std::map<Setting, std::size_t> runs_of;
  std::size_t run_count = 0;

  ScoreSettings scorer(double (*function)(const Setting&)) {
    return [this, function](const std::vector<Setting>& settings, std::size_t runs) {
      EXPECT_LE(runs, run_count);
      std::vector<double> scores;
      for (const Setting& setting : settings) {
        runs_of[setting] = std::max(runs_of[setting], runs);
        scores.push_back(function(setting));
      }
      return scores;
    };
  }
  std::size_t total() const {
    std::size_t sum = 0;
    for (const auto& [setting, runs] : runs_of) sum += runs;
    return sum;
  }
};

SearchResult search(double (*function)(const Setting&), const SearchOptions& options, const Setting& start = kStart) {
  Counter counter{{}, options.run_count};
  const SearchResult result = search_parameters(kRanges, start, options, counter.scorer(function));
  EXPECT_EQ(result.scored_runs, counter.total());
  EXPECT_EQ(result.setting_count, counter.runs_of.size());
  EXPECT_DOUBLE_EQ(result.score, function(result.best));
  EXPECT_DOUBLE_EQ(result.start_score, function(start));
  return result;
}

TEST(ParameterSearch, FindsTheBottomOfABowl) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SearchResult result = search(bowl, {.run_count = 18, .budget = 120.0, .seed = seed});
    for (std::size_t p = 0; p < kRanges.size(); ++p)
      EXPECT_NEAR(kRanges[p].place_of(result.best[p]), kRanges[p].place_of(kBest[p]), 0.02) << p << ", seed " << seed;
  }
}

/// A second, lower hill around the start hides the way up.
double two_hills(const Setting& setting) {
  double from_start = 0.0;
  for (std::size_t p = 0; p < kRanges.size(); ++p)
    from_start += std::pow(kRanges[p].place_of(setting[p]) - kRanges[p].place_of(kStart[p]), 2);
  return std::max(bowl(setting), 0.5 - 20.0 * from_start);
}

TEST(ParameterSearch, LeavesALesserHill) {
  EXPECT_GT(search(two_hills, {.run_count = 9, .budget = 120.0}).score, 0.99);
}

TEST(ParameterSearch, NeverEndsBelowItsStart) {
  const SearchResult result = search(bowl, {.run_count = 7, .budget = 20.0}, kBest);
  EXPECT_EQ(result.best, kBest);
  EXPECT_EQ(result.score, 1.0);
}

TEST(ParameterSearch, KeepsToItsBudget) {
  for (const std::size_t runs : {1U, 2U, 5U, 27U, 100U})
    for (const double budget : {1.0, 3.0, 10.0, 55.0}) {
      const SearchResult result = search(bowl, {.run_count = runs, .budget = budget});
      EXPECT_LE(static_cast<double>(result.scored_runs), std::max(1.0, budget) * static_cast<double>(runs)) << runs;
    }
}

TEST(ParameterSearch, IsTheSameForASeedAndOtherForAnother) {
  const SearchOptions options = {.run_count = 9, .budget = 12.0, .seed = 3};
  SearchOptions other = options;
  other.seed = 4;
  EXPECT_EQ(search(bowl, options).best, search(bowl, options).best);
  EXPECT_NE(search(bowl, options).best, search(bowl, other).best);
}

TEST(ParameterSearch, ScoresOnFewRunsFirst) {
  Counter counter{{}, 27};
  search_parameters(kRanges, kStart, {.run_count = 27, .budget = 30.0}, counter.scorer(bowl));
  std::map<std::size_t, int> settings_by_runs;
  for (const auto& [setting, runs] : counter.runs_of) ++settings_by_runs[runs];
  EXPECT_EQ(settings_by_runs.size(), 3U);
  EXPECT_GT(settings_by_runs[3], 2 * settings_by_runs[9]);
}

TEST(SearchRange, ValuesAndPlacesAgree) {
  for (const SearchRange& range : kRanges)
    for (int i = 0; i <= 100; ++i) {
      const double value = range.value_at(i / 100.0);
      EXPECT_GE(value, range.low);
      EXPECT_LE(value, range.high);
      EXPECT_TRUE(!range.whole || value == std::round(value));
      EXPECT_EQ(range.value_at(range.place_of(value)), value);
    }
  EXPECT_EQ(kRanges[1].value_at(0.5), 0.0316);  // three digits of the geometric mean
  EXPECT_EQ(kRanges[0].value_at(-1.0), -2.0);
  EXPECT_EQ(kRanges[0].place_of(17.0), 1.0);
}

}  // namespace
}  // namespace tubebin::calibration
