/// What there is to see in a cloud, a scene, a model or the results over a data set, for the 3D view.
#pragma once

#include <string>
#include <vector>

#include "tubebin/evaluation/scene_view.hpp"

namespace tubebin::results {

/// `path` is a cloud file, which may have scene.json beside it; a scene of a data set, DATASET/A10/007, loose or packed, or
/// of one pack, PACK.tar/A10/007; what model_tubes wrote for one cloud; or a results folder, whose worst scenes are shown. Throws IoError naming the file, or what `path` would have to hold.
std::vector<evaluation::SceneView> viewed_scenes(const std::string& path);

}  // namespace tubebin::results
