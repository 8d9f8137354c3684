// Checks one scene of a data set against the manifest and against what every scene promises.
#pragma once

#include <string>
#include <vector>

#include "tubebin/dataset/dataset_config.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/dataset/scene_id.hpp"
#include "tubebin/scene/dataset_files.hpp"

namespace tubebin::dataset {

/// What is wrong with the sizes and hashes of a recorded scene's files, one sentence each.
std::vector<std::string> check_files(const scene::DatasetFiles& files, const ManifestRecord& record);

/// What is wrong with a recorded scene, one sentence each; empty for a sound one. Checks the files' sizes and hashes;
/// that scene.json, tubes.txt and the cloud can be read and agree with each other; one colour a label, all different;
/// that every point lies on the surface that its label names; contacts within the limits, every tube held.
std::vector<std::string> verify_scene(const scene::DatasetFiles& files, const DatasetConfig& config, const SceneId& id,
                                      const ManifestRecord& record);

}  // namespace tubebin::dataset
