/// Merging the shards of a data set, made in folders of their own or in one.
#pragma once

#include <string>
#include <vector>

#include "tubebin/jobs/progress.hpp"

namespace tubebin::dataset {

struct MergeReport {
  int signal = 0;                      ///< that ended it early; 0: none
  std::size_t scenes = 0;              ///< that the configuration asks for
  std::size_t complete = 0;            ///< sound ones, in `output` and its manifest now
  std::vector<std::string> missing;    ///< "A10/007": scenes that no folder has
  std::vector<std::string> unchecked;  ///< "A10/007": scenes of which nobody can tell, each with its problem
  std::vector<std::string> problems;   ///< "DIR/A10/007: cloud.pcd is missing"
  std::vector<std::string> commands;   ///< of the shell, that make exactly what is missing or damaged

  bool is_whole() const { return complete == scenes; }
};

/// Makes `output` the data set that one machine would have made: checks that all folders are of one configuration,
/// seed and version, compares every file with its recorded hash, links the scenes (copies them where the disk is another
/// one) and writes one manifest in the configuration's order. Without folders it completes the manifest of `output`,
/// where the shards wrote into that one folder. The folders stay as they are; merging again goes on.
///
/// Throws IoError, ConfigError where the folders don't belong together (with all differing keys) or a run is writing to
/// `output`.
MergeReport merge_datasets(const std::string& output, const std::vector<std::string>& folders, int jobs,
                           jobs::Progress::Style progress);

}  // namespace tubebin::dataset
