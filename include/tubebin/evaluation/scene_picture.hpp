/// Pictures of a scene as the scanner sees it: ground truth, labels, and which points are wrong.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/evaluation/run_score.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin {

/// The points of a filtered cloud with their ground-truth labels (0 = bin) and predicted ids.
struct LabelledPoints {
  std::vector<Point> points;  ///< metres, world frame
  std::vector<SegmentId> truth;
  std::vector<SegmentId> predicted;
  Scanner scanner;
  double ratio = 1.0;  ///< of the scanner's points that are here, so that the rest can be filled
};

/// PNG files. Matched labels take the colour of their tube, labels without a tube are grey, points without a
/// label black; in `errors` correct points are light, wrong ones vermilion, those without a label black.
struct ScenePicture {
  std::string truth;
  std::string labels;
  std::string errors;
  int width = 0;  ///< pixels
  int height = 0;
};

ScenePicture draw_scene(const LabelledPoints& points);

/// The run's points, where its clouds were kept and its scene is known. Points of the bin without a label are
/// left out.
std::optional<LabelledPoints> read_points(const RunScore& run);

}  // namespace tubebin
