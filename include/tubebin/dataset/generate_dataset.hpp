/// All scenes of a data set, by worker processes, into its folder.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tubebin/dataset/dataset_config.hpp"
#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/dataset/scene_id.hpp"
#include "tubebin/jobs/progress.hpp"
#include "tubebin/jobs/worker_pool.hpp"

namespace tubebin::dataset {

struct GenerationReport {
  int signal = 0;                   ///< that ended the run early; 0: none
  std::size_t complete_before = 0;  ///< scenes of those asked for
  std::size_t made = 0;
  std::vector<std::string> failed;     ///< scenes given up, each with its reasons
  std::map<std::string, int> rejects;  ///< failed attempts by reason
  double seconds = 0.0;                ///< wall-clock time of the run

  std::size_t rejects_total() const;
};

/// Makes those of `scenes` that are not complete. Where `pack` has a name, they end in DIR/packs/NAME.tar, in their
/// order. Throws IoError, ConfigError.
GenerationReport generate_dataset(DatasetFolder& folder, const std::vector<SceneId>& scenes, int jobs,
                                  jobs::Progress::Style progress, const std::string& pack = "");

}  // namespace tubebin::dataset
