/// The paper's own figures (data/paper/results.yaml), to be shown beside ours.
#pragma once

#include <map>
#include <string>

namespace tubebin::evaluation {

struct PaperFigures {
  /// Table 1: seconds to generate a test case, by set and number of tubes.
  std::map<std::string, std::map<int, double>> generation_seconds;
  /// Table 2: seconds to model a cloud of set A, by ratio and number of tubes.
  std::map<double, std::map<int, double>> modelling_seconds;
  /// The points of Figure 8 that the text gives: micro-recall on set B at ratio 0.3, by number of tubes.
  std::map<int, double> micro_recall_set_b;
};

const PaperFigures& paper_figures();

}  // namespace tubebin::evaluation
