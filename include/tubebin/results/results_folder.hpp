/// Reads and scores the results folder of model_tubes (docs/results_format.md).
#pragma once

#include <string>
#include <vector>

#include "tubebin/evaluation/evaluation.hpp"

namespace tubebin::results {

struct ResultsOptions {
  std::string dataset;  ///< the data set's folder; empty: as each results folder says
  int jobs = 1;         ///< threads
  evaluation::OnProgress on_progress = {};
  std::vector<std::string> names = {};  ///< of the folders, to tell them apart by; empty: what differs is told
};

/// Reads one or several results folders together: shards of one call, or calls of other options, whose runs have the name
/// of the setting ("radius: estimated") in the place of the method's, or after it where there are several. Runs that an index asks for and that are not there yet are
/// left out and named; failed ones count as zero. Throws IoError naming the file and the place where a folder
/// is no results folder, has no complete run, or a file in it is damaged; and where two folders of one name have the same
/// run. Throws ConfigError where there are other than as many names as folders.
evaluation::Evaluation read_results(const std::vector<std::string>& folders, const ResultsOptions& options);

}  // namespace tubebin::results
