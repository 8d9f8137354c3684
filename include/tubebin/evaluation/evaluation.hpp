/// Scored runs of an algorithm over a data set.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "tubebin/evaluation/run_score.hpp"

namespace tubebin::evaluation {

/// Scored runs of one or several algorithms, with what is missing.
struct Evaluation {
  std::string source;                                      ///< the folders, as they were given
  std::vector<RunScore> runs;                              ///< by set, tubes, case, method (or setting) and ratio
  std::vector<std::string> missing;                        ///< runs or scenes without a result, each named
  std::vector<std::vector<std::string>> unfinished_calls;  ///< results folders of each call that lacks runs
  bool missing_counts_as_zero = false;                     ///< else they are not among `runs`
  std::vector<std::string> failed;  ///< runs that the algorithm could not do, each named with the reason
  std::vector<std::string> notes;   ///< what could not be measured, and why
  std::string configuration;        ///< what the results were made with, as a text
};

/// Told how many scenes of how many are done, from one thread at a time; may be empty.
using OnProgress = std::function<void(std::size_t done, std::size_t total)>;

}  // namespace tubebin::evaluation
