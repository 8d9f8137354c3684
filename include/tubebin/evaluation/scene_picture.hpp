/// Pictures of a scene as the scanner sees it: ground truth, labels, and which points are wrong.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/evaluation/run_score.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::evaluation {

/// The points of a filtered cloud with their ground-truth labels (0 = bin) and predicted ids.
struct LabelledPoints {
  std::vector<cloud::Point> points;  ///< metres, world frame
  std::vector<SegmentId> truth;      ///< one a point; none where it is not known, which the 3D view alone takes
  std::vector<SegmentId> predicted;  ///< as `truth`
  scene::Scanner scanner;
  double ratio = 1.0;                     ///< of the scanner's points that are here, so that the rest can be filled
  std::vector<TubeLine> true_tubes = {};  ///< tube k at [k - 1]; may be empty, as the next
  std::vector<TubeLine> found_tubes = {};
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

}  // namespace tubebin::evaluation
