/// model_tubes: from a cloud to tubes and labels, by the steps of the paper's Section 4.
#pragma once

#include <string>
#include <vector>

#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/greedy_joining.hpp"
#include "tubebin/modeling/region_growing.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

enum class ModelingMethod { centerline, region_growing };

struct ModelingOptions {
  ModelingMethod method = ModelingMethod::centerline;
  std::uint64_t seed = 1;
  double radius = 0.0;       ///< metres; 0: estimated from the cloud
  double tube_length = 0.0;  ///< metres; 0: estimated from the cloud where its tubes agree
  FilteringOptions filtering;
  RegionGrowingOptions region_growing;
  GreedyJoiningOptions greedy_joining;
};

void describe(Fields& fields, ModelingOptions& options);

/// Wall-clock seconds of each step.
struct StageSeconds {
  double filtering = 0.0;
  double segmentation = 0.0;
  double fitting = 0.0;
  double joining = 0.0;
  double labeling = 0.0;

  double total() const { return filtering + segmentation + fitting + joining + labeling; }
};

struct ModelingResult {
  std::vector<std::uint32_t> source;  ///< of each filtered point, its index in the input
  std::vector<cloud::Label> labels;   ///< of each filtered point: k for tubes[k - 1], 0 where it belongs to none
  std::vector<TubeModel> tubes;
  double radius = 0.0;       ///< metres: as given, or as estimated
  double tube_length = 0.0;  ///< metres: as given, or as estimated; 0 where the tubes have no common length
  double noise = 0.0;        ///< metres, standard deviation of the points' distances to the fitted surfaces
  double spacing = 0.0;      ///< metres between neighbouring filtered points
  StageSeconds seconds;
};

ModelingResult model_tubes(const ModelingInput& input, const ModelingOptions& options);

}  // namespace tubebin::modeling
