/// Modelling every cloud of a data set by several methods and at several ratios into a results folder
/// (docs/results_format.md).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tubebin/jobs/progress.hpp"
#include "tubebin/jobs/shard.hpp"
#include "tubebin/results/model_cloud.hpp"

namespace tubebin::results {

struct BatchOptions {
  std::string dataset;
  std::string results;
  std::vector<modeling::ModelingMethod> methods = {modeling::ModelingMethod::centerline};
  std::vector<double> ratios = {1.0};
  int jobs = 1;
  int cases = 0;              ///< of each set and number of tubes, the first ones; 0: all
  double time_limit = 600.0;  ///< seconds a run
  bool keep_clouds = false;
  std::vector<std::string> scenes = {};         ///< these alone; empty: all
  std::vector<std::string> other_results = {};  ///< runs that one of these folders has are not done again
  std::optional<jobs::Shard> shard;  ///< does the runs of these clouds only, while others may do the other shards
  /// Told, before a shard's work begins, how many of how many clouds are its own, and their share of the work.
  std::function<void(std::size_t own, std::size_t all, double share)> on_shard = [](auto...) {};
};

struct BatchReport {
  std::size_t runs = 0;
  std::size_t complete_before = 0;
  std::size_t made = 0;
  std::vector<std::string> failed;  ///< a line each
  int signal = 0;                   ///< that ended it early, 0 if none did
  double seconds = 0.0;
};

/// Does the runs that the results folder does not have yet. Throws IoError, and ConfigError where the folder holds
/// results of another data set, other options or another seed.
BatchReport model_dataset(const BatchOptions& options, const ModelConfig& config, jobs::Progress::Style progress);

}  // namespace tubebin::results
