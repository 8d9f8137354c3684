// Micro-recall of settings on runs, each found once and kept in a journal.
#pragma once

#include <map>
#include <optional>

#include "tubebin/dataset/calibration.hpp"
#include "tubebin/dataset/line_journal.hpp"
#include "tubebin/dataset/modeling_run.hpp"
#include "tubebin/dataset/worker_pool.hpp"

namespace tubebin {

/// A signal (its number) asked to stop.
struct CalibrationStopped {
  int signal = 0;
};

class CalibrationTrials {
 public:
  /// Reads the journal in `folder`. Throws ConfigError where it is of other options or of another version, and IoError.
  CalibrationTrials(const std::string& folder, const CalibrationOptions& options, const DatasetFiles& dataset,
                    const ModelConfig& start, std::vector<TunedParameter> parameters, Progress& progress);

  /// Of each setting, its micro-recalls on the runs, in their order. Throws CalibrationStopped.
  std::vector<std::vector<double>> recalls(const std::vector<Setting>& settings, const std::vector<ModelingRun>& runs);

  std::size_t runs_made() const { return runs_made_; }
  std::size_t runs_before() const { return runs_before_; }
  std::size_t failed_runs() const { return failed_; }

 private:
  using Key = std::string;
  struct Trial {
    Setting setting;
    ModelingRun run;
    Key key;
  };

  void read_journal();
  Key key_of(const Setting& setting, const ModelingRun& run);
  std::string cloud_hash(const ModelingRun& run);
  void find_missing(const std::vector<Trial>& missing);
  AttemptResult attempt(const Trial& trial) const;
  void keep(const Trial& trial, const JobOutcome& outcome);

  const CalibrationOptions& options_;
  const DatasetFiles& dataset_;
  const ModelConfig& start_;
  std::vector<TunedParameter> parameters_;
  Progress& progress_;
  LineJournal journal_;
  std::map<Key, double> recall_of_;
  std::map<Key, bool> used_;  ///< of recall_of_: those that this call has asked for
  std::map<std::string, std::string> hash_of_cloud_;
  std::size_t runs_made_ = 0, runs_before_ = 0, failed_ = 0;
};

/// The configuration with the setting's values.
ModelConfig apply_setting(const ModelConfig& config, const std::vector<TunedParameter>& parameters,
                          const Setting& setting);
/// The parameters' values in the configuration.
Setting setting_of(const ModelConfig& config, const std::vector<TunedParameter>& parameters);

}  // namespace tubebin
