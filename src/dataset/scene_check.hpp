#pragma once

#include <string>
#include <vector>

#include "tubebin/dataset/manifest.hpp"
#include "tubebin/scene/dataset_files.hpp"

namespace tubebin::dataset {

/// What is wrong with the sizes and hashes of a recorded scene's files, one sentence each.
std::vector<std::string> check_files(const scene::DatasetFiles& files, const ManifestRecord& record);

}  // namespace tubebin::dataset
