/// The search of calibrate_modeler (docs/calibration.md): successive halving over settings spread through the ranges
/// (Karnin, Koren and Somekh 2013; Jamieson and Talwalkar 2016), then a compass search from the best of them (Kolda,
/// Lewis and Torczon 2003). It needs no derivatives, takes whole numbers, and can score several settings at once.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace tubebin::calibration {

/// A parameter's range. A logarithmic one is searched by factors, and is above 0.
struct SearchRange {
  double low = 0.0;
  double high = 1.0;
  bool logarithmic = false;
  bool whole = false;  ///< whole numbers only

  /// The value at a place in [0, 1] of the range, with three significant digits or whole, within the range.
  double value_at(double place) const;
  /// The place of a value, 0 or 1 where it lies outside.
  double place_of(double value) const;
};

/// A value for each parameter.
using Setting = std::vector<double>;

/// Scores several settings, each on the first `run_count` training runs; more is better.
using ScoreSettings = std::function<std::vector<double>(const std::vector<Setting>& settings, std::size_t run_count)>;

struct SearchOptions {
  std::size_t run_count = 1;  ///< training runs, of which the first few serve for a first opinion
  double budget = 40.0;       ///< how many settings could be scored on all of them
  std::uint64_t seed = 1;
};

struct SearchResult {
  Setting best;
  double score = 0.0;             ///< of it, on all training runs
  double start_score = 0.0;       ///< of the setting that the search began with
  std::size_t setting_count = 0;  ///< that were scored
  std::size_t scored_runs = 0;    ///< in all, each once
};

/// The setting with the highest score on all training runs that the budget finds; `start` is among those that compete,
/// so `score` is never below `start_score`. The same arguments give the same result. The budget may be passed by what
/// is scored at once.
SearchResult search_parameters(const std::vector<SearchRange>& ranges, const Setting& start,
                               const SearchOptions& options, const ScoreSettings& score);

}  // namespace tubebin::calibration
