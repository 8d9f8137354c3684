/// One scene of a data set, from its seed to its content.
#pragma once

#include <optional>

#include "tubebin/dataset/scene_store.hpp"

namespace tubebin::dataset {

struct GeneratedScene {
  std::string failure;  ///< in a word, as rejects are counted by; empty where the scene is good
  std::string failure_detail;
  SceneContent content;  ///< empty after a failure
  physics::DropFigures physics;
  std::map<std::string, double> seconds;  ///< wall-clock time of each stage
};

/// Seed of the attempt (from 0) at the scene.
std::uint64_t attempt_seed(const DatasetConfig& config, const SceneId& id, int attempt);

/// Who covers whom in the scanner's image, and who lies on whom.
scene::PileRelations relate_pile(const scene::Scene& scene);

/// Generates, drops and scans. The result depends on the arguments (and the tool's version) alone.
GeneratedScene generate_scene(const DatasetConfig& config, const SceneId& id, int attempt);

}  // namespace tubebin::dataset
