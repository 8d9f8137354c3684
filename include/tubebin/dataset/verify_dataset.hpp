/// Checks a data set against its manifest and against what every scene promises.
#pragma once

#include <string>
#include <vector>

#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/dataset/scene_id.hpp"
#include "tubebin/jobs/progress.hpp"

namespace tubebin::dataset {

struct VerificationReport {
  int signal = 0;  ///< that ended the check early; 0: none
  std::size_t checked = 0;
  std::vector<SceneId> damaged;       ///< scenes with problems, or that the manifest doesn't record
  std::vector<std::string> problems;  ///< "A10/007: cloud.pcd is missing"
  std::size_t missing = 0;            ///< scenes of config.yaml that were never completed

  bool sound() const { return problems.empty(); }
};

/// Checks all scenes of the data set in worker processes. Throws IoError, ConfigError where the folder is no data
/// set, or a run is writing to it.
VerificationReport verify_dataset(const std::string& folder, int jobs, jobs::Progress::Style progress);

/// Removes the damaged scenes, and lines that are no records, from the manifest, so that generation makes those
/// scenes anew.
void forget_damage(DatasetFolder& folder, const VerificationReport& report);

}  // namespace tubebin::dataset
