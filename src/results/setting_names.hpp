/// Names for results of one method with different options, which stand side by side.
#pragma once

#include <string>
#include <vector>

#include "results/results_index.hpp"

namespace tubebin::results {

struct IndexedFolder {
  std::string folder;  ///< as it was given
  ResultsIndex index;
};

/// A name a folder; folders of one name are read as shards of one call. `given` are the user's, or none. Without them the
/// names are empty unless folders are to have the same run under different conditions; then they tell what differs
/// ("radius: estimated"), or the first folder of the conditions where more than two options differ. Throws ConfigError
/// where there are not as many names as folders.
std::vector<std::string> setting_names(const std::vector<IndexedFolder>& folders,
                                       const std::vector<std::string>& given);

/// What the runs of two folders depend on and is not the same: "radius: 0.0125 and radius: estimated".
std::string describe_difference(const ResultsIndex& a, const ResultsIndex& b);

}  // namespace tubebin::results
