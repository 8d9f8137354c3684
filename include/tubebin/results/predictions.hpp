/// Scores any program's labelled clouds on a data set (docs/foreign_algorithms.md).
#pragma once

#include <string>
#include <vector>

#include "tubebin/evaluation/cloud_pair.hpp"
#include "tubebin/evaluation/evaluation.hpp"

namespace tubebin::results {

struct PredictionOptions {
  evaluation::SegmentField field =
      evaluation::SegmentField::automatic;  ///< of the predictions; the ground truth's is its labels
  int jobs = 1;                             ///< threads
  evaluation::OnProgress on_progress = {};
  std::vector<std::string> names = {};  ///< of the folders; empty: the last folder of each path
};

/// Each of the folders is a method of its own. The prediction of scene A10/007 is `folder`/A10/007.pcd or `folder`/A10/007/labeled.pcd (or .ply): points
/// of the scene's cloud in any order, each with a label or a colour a tube; label 0 or black is no tube.
/// Micro-recall is over the points of tubes, or over `folder`/A10/007/filtered.pcd where the program gives
/// the points that it worked on: points of the scene's cloud, whose ground truth is the data set's, and at least
/// kCoverageMin of them. A scene without a prediction counts as zero and is named.
///
/// Throws IoError naming the file where the data set has no labelled clouds, no scene has a prediction, or a
/// prediction does not belong to its scene; ConfigError where two folders have one name.
evaluation::Evaluation score_predictions(const std::string& dataset, const std::vector<std::string>& folders,
                                         const PredictionOptions& options);

}  // namespace tubebin::results
