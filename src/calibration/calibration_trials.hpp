// Micro-recall of settings on runs, each found once and kept in a journal.
#pragma once

#include <map>
#include <optional>

#include "tubebin/calibration/calibration.hpp"
#include "tubebin/jobs/batch.hpp"
#include "tubebin/jobs/line_journal.hpp"
#include "tubebin/results/modeling_run.hpp"

namespace tubebin::calibration {

/// A signal (its number) asked to stop.
struct CalibrationStopped {
  int signal = 0;
};

class CalibrationTrials {
 public:
  /// Reads the journal in `folder`. Throws ConfigError where it is of other options or of another version, and IoError.
  CalibrationTrials(const OutputFolder& folder, const CalibrationOptions& options, const scene::DatasetFiles& dataset,
                    const results::ModelConfig& start, std::vector<TunedParameter> parameters,
                    jobs::Progress& progress);

  /// Of each setting, its micro-recalls on the runs, in their order. Throws CalibrationStopped.
  std::vector<std::vector<double>> recalls(const std::vector<Setting>& settings,
                                           const std::vector<results::ModelingRun>& runs);

  std::size_t runs_made() const { return runs_made_; }
  std::size_t runs_before() const { return runs_before_; }
  std::size_t failed_runs() const { return failed_; }

 private:
  using Key = std::string;
  struct Trial {
    Setting setting;
    results::ModelingRun run;
    Key key;
  };

  void read_journal();
  Key key_of(const Setting& setting, const results::ModelingRun& run);
  const scene::InputHashes& hashes_of(const results::ModelingRun& run);
  void find_missing(const std::vector<Trial>& missing);
  jobs::AttemptResult attempt(const Trial& trial) const;
  void keep(const Trial& trial, const jobs::JobOutcome& outcome);

  const CalibrationOptions& options_;
  const scene::DatasetFiles& dataset_;
  scene::DatasetHashes hashes_;
  const results::ModelConfig& start_;
  std::vector<TunedParameter> parameters_;
  jobs::Progress& progress_;
  jobs::LineJournal journal_;
  std::map<Key, double> recall_of_;
  std::map<Key, bool> used_;  ///< of recall_of_: those that this call has asked for
  std::map<std::string, scene::InputHashes> hashes_of_scene_;
  std::size_t runs_made_ = 0, runs_before_ = 0, failed_ = 0;
};

/// The configuration with the setting's values.
results::ModelConfig apply_setting(const results::ModelConfig& config, const std::vector<TunedParameter>& parameters,
                                   const Setting& setting);
/// The parameters' values in the configuration.
Setting setting_of(const results::ModelConfig& config, const std::vector<TunedParameter>& parameters);

}  // namespace tubebin::calibration
