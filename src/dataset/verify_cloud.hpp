/// A scene's clouds and depth images against its scene.json.
#pragma once

#include <string>
#include <vector>

#include "tubebin/scene/depth_image.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::dataset {

/// What is wrong with the layout, the labels, the colours and the places of the points, one sentence each.
std::vector<std::string> check_cloud(const cloud::Cloud& cloud, const scene::SceneRecord& scene);

/// The same of the twin without the scanner's effects.
std::vector<std::string> check_clean_cloud(const cloud::Cloud& clean, const scene::SceneRecord& scene);

/// Whether depth.png and labels.png are those of the cloud, which is as check_cloud wants it.
std::vector<std::string> check_depth_image(const scene::DepthImage& found, const cloud::Cloud& cloud,
                                           const scene::SceneRecord& scene);

}  // namespace tubebin::dataset
