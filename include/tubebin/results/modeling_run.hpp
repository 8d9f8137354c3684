/// A run: one cloud of a data set, modelled by one method at one downsampling ratio.
#pragma once

#include <string>
#include <vector>

#include "tubebin/results/model_cloud.hpp"

namespace tubebin::results {

struct ModelingRun {
  std::string scene;  ///< "A10/007"
  std::string cloud;  ///< the name of its file
  modeling::ModelingMethod method = modeling::ModelingMethod::centerline;
  double ratio = 1.0;

  /// Beneath the results: "A10/007/centerline_0.3".
  ConfinedPath folder() const { return ConfinedPath(scene) / fmt::format("{}_{}", name_of(method), ratio); }
};

/// The configuration with the run's method, ratio and seed. Both methods get the same seed, and so the same points.
ModelConfig run_config(const ModelConfig& config, const ModelingRun& run);

/// Ground-truth label of every input point: its own, or the one whose colour scene.json says it has. Empty where the
/// cloud has neither.
std::vector<cloud::Label> truth_labels(const CloudToModel& input);

}  // namespace tubebin::results
