/// calibrate_modeler: the parameters of a modelling method, tuned on a part of a data set by micro-recall and measured on
/// the rest (docs/calibration.md).
#pragma once

#include <string>
#include <vector>

#include "tubebin/calibration/parameter_search.hpp"
#include "tubebin/jobs/progress.hpp"
#include "tubebin/results/model_cloud.hpp"

namespace tubebin::calibration {

/// A number of modeling.yaml that may be tuned.
struct TunedParameter {
  std::string key;  ///< "region_growing.smoothness_deg"
  SearchRange range;
};

/// The parameters that a method is tuned by where nobody says which.
std::vector<TunedParameter> default_parameters(modeling::ModelingMethod method);

/// "KEY" with its default range, "KEY=LOW:HIGH" or "KEY=LOW:HIGH:log". Throws ConfigError where the key is no number of a
/// configuration, decides which points are counted, or can't take these values.
TunedParameter parse_parameter(const std::string& text);

struct CalibrationOptions {
  std::string dataset;
  std::string output;                      ///< modeling.yaml; the trials go into the folder `output`.trials
  std::vector<TunedParameter> parameters;  ///< empty: the method's default ones
  std::vector<double> ratios = {1.0};      ///< of the downsampling, each of which makes a run of each cloud
  double held_back = 0.5;                  ///< of the scenes: not tuned on
  double budget = 40.0;                    ///< how often all training clouds may be modelled
  std::uint64_t seed = 1;                  ///< of the split and of the search
  int jobs = 1;
  double time_limit = 600.0;  ///< seconds a run, beyond which it counts as 0
};

/// Micro-recalls of the same runs before and after.
struct BeforeAfter {
  std::vector<double> before, after;

  double mean_before() const;
  double mean_after() const;
  double mean_gain() const { return mean_after() - mean_before(); }
  /// Standard error of the mean gain, from the runs' differences; 0 for a single run.
  double gain_error() const;
};

struct CalibrationReport {
  std::vector<TunedParameter> parameters;
  Setting before, after;
  BeforeAfter training, held_back;
  std::vector<std::string> training_scenes, held_back_scenes;
  std::size_t setting_count = 0;
  std::size_t runs_made = 0;    ///< by this call
  std::size_t runs_before = 0;  ///< that earlier calls had made
  std::size_t failed_runs = 0;  ///< that crashed or took too long, and count as 0
  int signal = 0;  ///< that ended it early, 0 if none did; then nothing but runs_made and runs_before holds
  double seconds = 0.0;

  /// Whether the tuned parameters are at least as good on scenes that they were not tuned on.
  bool is_recommended() const { return held_back.mean_gain() >= 0.0; }
};

/// Tunes `start`, and writes the output once all is done. Ended early in any way, the same call goes on where it was.
/// Throws IoError, and ConfigError where the data set or the options can't be meant.
CalibrationReport calibrate_modeler(const CalibrationOptions& options, const results::ModelConfig& start,
                                    jobs::Progress::Style progress);

}  // namespace tubebin::calibration
