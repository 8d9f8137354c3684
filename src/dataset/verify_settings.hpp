// What a scene was made with, against the configuration and the scene's seed.
#pragma once

#include "tubebin/dataset/dataset_config.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::dataset {

/// Problems with the scene's scanners and with the numbers that were drawn for it; `config` has the latter in their places.
/// Of a pile that was lifted from, the step before tells.
std::vector<std::string> check_settings(const scene::SceneRecord& scene, const DatasetConfig& config);

}  // namespace tubebin::dataset
