/// The clouds of a data set, found by their files.
#pragma once

#include <string>
#include <vector>

#include "tubebin/scene/dataset_files.hpp"

namespace tubebin::results {

struct CloudFile {
  std::string scene;  ///< its name: its folder beneath the data set's, "A10/007"
  std::string file;   ///< "cloud.pcd"
};

/// Every cloud.pcd and cloud.ply, scenes of fewer tubes first. Throws IoError where there is none.
std::vector<CloudFile> find_clouds(const scene::DatasetFiles& files);

}  // namespace tubebin::results
