/// The files of the runs in a results folder, one parser each (docs/results_format.md). All throw IoError, which names the file and
/// the place in it, for text that is not as that page says; nothing that the text states is trusted before it is checked.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tubebin/evaluation/centerline.hpp"
#include "tubebin/evaluation/contingency.hpp"
#include "tubebin/modeling/tube_model.hpp"
#include "tubebin/scene/input_hashes.hpp"

namespace tubebin::results {

/// result.json: the points of one run.
struct RunCounts {
  std::string scene;
  std::string set;
  int tubes = 0;
  int case_number = 0;
  int model_tubes = 0;
  scene::InputHashes made_from;
  evaluation::Contingency contingency;
};

RunCounts parse_run_counts(std::string_view text, const std::string& name);
/// model.json: the axis of each tube.
std::vector<evaluation::TubeLine> parse_model_tubes(std::string_view text, const std::string& name);
/// model.json: what of the tubes their points' labels follow from.
std::vector<modeling::TubeModel> parse_labeling_tubes(std::string_view text, const std::string& name);
/// times.json: the modelling time, seconds.
double parse_modeling_seconds(std::string_view text, const std::string& name);
/// failures.jsonl: reasons by run folder.
std::map<std::string, std::string> parse_failures(std::string_view text, const std::string& name);

/// "A10/007/centerline_0.3": the ratio with as few digits as tell it exactly.
std::string run_folder(const std::string& scene, const std::string& method, double ratio);

}  // namespace tubebin::results
