/// Going on with what model_dataset began, by the options in its results.
#pragma once

#include <string>
#include <vector>

#include "tubebin/results/model_dataset.hpp"

namespace tubebin::results {

/// The call that results folders, one or those of its shards, were made with, for the runs that none of them has yet. They
/// go into the first one. Throws IoError where it is no results folder, ConfigError where another version made it.
struct ResumedBatch {
  BatchOptions options;
  ModelConfig config;
};
ResumedBatch resume_batch(const std::vector<std::string>& results);

}  // namespace tubebin::results
