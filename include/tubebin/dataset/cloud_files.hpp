/// The clouds of a data set, found by their files.
#pragma once

#include <string>
#include <vector>

namespace tubebin {

struct SceneName {
  std::string set;
  std::size_t tubes = 0;
  int case_number = 0;
};

/// "A10/007" is set A, ten tubes, case 7; of another name only the first folder is known.
SceneName parse_scene_name(const std::string& scene);

struct CloudFile {
  std::string scene;  ///< its folder beneath the data set's, "A10/007"
  std::string path;
};

/// Every cloud.pcd and cloud.ply, scenes of fewer tubes first. Throws IoError where there is none.
std::vector<CloudFile> find_clouds(const std::string& dataset);

}  // namespace tubebin
