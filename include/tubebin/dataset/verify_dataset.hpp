/// Checks a data set against its manifest and against what every scene promises.
#pragma once

#include <string>
#include <vector>

#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/dataset/scene_id.hpp"
#include "tubebin/jobs/progress.hpp"
#include "tubebin/scene/dataset_files.hpp"

namespace tubebin::dataset {

/// What is wrong with a recorded scene, one sentence each; empty for a sound one. Checks the files' sizes and hashes;
/// that scene.json, tubes.txt and the cloud can be read and agree with each other; one colour a label, all different;
/// that every point lies on the surface that its label names; contacts within the limits, every tube held.
std::vector<std::string> verify_scene(const scene::DatasetFiles& files, const DatasetConfig& config, const SceneId& id,
                                      const ManifestRecord& record);

struct VerificationReport {
  int signal = 0;  ///< that ended the check early; 0: none
  std::size_t checked = 0;
  std::vector<SceneId> damaged;       ///< scenes with problems, or that the manifest doesn't record
  std::vector<std::string> problems;  ///< "A10/007: cloud.pcd is missing"
  std::size_t missing = 0;            ///< scenes of config.yaml that were never completed

  bool sound() const { return problems.empty(); }
};

/// Checks all scenes of the data set in worker processes. Throws IoError, ConfigError where the folder is no data
/// set, or a run is writing to it.
VerificationReport verify_dataset(const std::string& folder, int jobs, jobs::Progress::Style progress);

/// Removes the damaged scenes, and lines that are no records, from the manifest, so that generation makes those
/// scenes anew.
void forget_damage(DatasetFolder& folder, const VerificationReport& report);

}  // namespace tubebin::dataset
