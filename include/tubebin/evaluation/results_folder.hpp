/// Reads and scores the results folder of model_tubes (docs/results_format.md).
#pragma once

#include <string>

#include "tubebin/evaluation/evaluation.hpp"

namespace tubebin {

struct ResultsOptions {
  std::string dataset;  ///< the data set's folder; empty: as the results folder says
  int jobs = 1;         ///< threads
  OnProgress on_progress;
};

/// Runs that the index asks for and that are not there yet are left out and named; failed ones count as zero.
/// Throws IoError naming the file and the place where the folder is no results folder, has no complete run,
/// or a file in it is damaged.
Evaluation read_results(const std::string& folder, const ResultsOptions& options);

}  // namespace tubebin
