/// Reads and scores the results folder of model_tubes (docs/results_format.md).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tubebin/evaluation/run_score.hpp"

namespace tubebin {

/// Scored runs of one or several algorithms, with what is missing.
struct Evaluation {
  std::string source;                ///< the folder, as it was given
  std::string dataset;               ///< the data set's folder; empty where it is not known
  std::vector<RunScore> runs;        ///< by set, tubes, case, method and ratio
  std::vector<std::string> missing;  ///< runs or scenes without a result, each named
  std::vector<std::string> failed;   ///< runs that the algorithm could not do, each named with the reason
  std::vector<std::string> notes;    ///< what could not be measured, and why
  std::string configuration;         ///< what the results were made with, as a text
};

struct ResultsOptions {
  std::string dataset;  ///< the data set's folder; empty: as the results folder says
  int jobs = 1;         ///< threads
};

/// Runs that the index asks for and that are not there yet are left out and named; failed ones count as zero.
/// Throws IoError naming the file and the place where the folder is no results folder, has no complete run,
/// or a file in it is damaged.
Evaluation read_results(const std::string& folder, const ResultsOptions& options);

/// The set, number of tubes and case that a scene's name tells: "A10/007" is set A, ten tubes, case 7. Where
/// it has another form, the set is its first folder and the other two are 0.
RunKey parse_scene_name(const std::string& name);

}  // namespace tubebin
