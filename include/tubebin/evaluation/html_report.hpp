/// One self-contained HTML file with everything that was measured; it opens without a network.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "tubebin/evaluation/paper_comparison.hpp"
#include "tubebin/evaluation/scene_picture.hpp"

namespace tubebin::evaluation {

/// The points of a run with their labels, or nothing where they are not to be had.
using ReadPoints = std::function<std::optional<LabelledPoints>(const RunScore&)>;

struct ReportInput {
  const Evaluation& evaluation;
  const GenerationSeconds* generation = nullptr;  ///< maybe empty: compare with the paper; null: don't
  ReadPoints read_points = {};                    ///< for the pictures; may be empty
};

std::string format_html_report(const ReportInput& input);

/// The runs that the report shows: the three worst of each method, at most one a scene.
std::vector<const RunScore*> pictured_runs(const std::vector<RunScore>& runs);

}  // namespace tubebin::evaluation
