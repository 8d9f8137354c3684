/// Methods, or settings of one, on the same clouds.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tubebin/evaluation/run_score.hpp"
#include "tubebin/evaluation/summary.hpp"
#include "tubebin/evaluation/table.hpp"

namespace tubebin::evaluation {

/// Means over the scenes of a set that both have runs of, a scene's own value being the mean over the ratios that both
/// have.
struct Comparison {
  std::string set;
  std::string first;  ///< method or setting
  std::string second;
  int scenes = 0;
  double recall_first = 0.0;  ///< micro-recall
  double recall_second = 0.0;
  Interval gain = {};  ///< second - first, scene by scene
  int better = 0;      ///< scenes in which the second is better
  int worse = 0;
};

/// The method of the first run with each other one, in the order of the runs, a set each; none where there is one method.
std::vector<Comparison> compare_methods(std::span<const RunScore> runs);

Table side_by_side_table(std::span<const Comparison> comparisons);

}  // namespace tubebin::evaluation
