/// Reads and scores the results folder of model_tubes (docs/results_format.md).
#pragma once

#include <string>
#include <vector>

#include "tubebin/evaluation/evaluation.hpp"

namespace tubebin::results {

struct ResultsOptions {
  std::string dataset;  ///< the data set's folder; empty: as each results folder says
  int jobs = 1;         ///< threads
  evaluation::OnProgress on_progress;
};

/// Reads one or several results folders together. Runs that an index asks for and that are not there yet are
/// left out and named; failed ones count as zero. Throws IoError naming the file and the place where a folder
/// is no results folder, has no complete run, or a file in it is damaged; and where two folders have the same
/// run.
evaluation::Evaluation read_results(const std::vector<std::string>& folders, const ResultsOptions& options);

}  // namespace tubebin::results
