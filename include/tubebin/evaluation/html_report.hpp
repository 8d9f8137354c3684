/// One self-contained HTML file with everything that was measured; it opens without a network.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tubebin/evaluation/paper_comparison.hpp"
#include "tubebin/evaluation/scene_picture.hpp"

namespace tubebin::evaluation {

/// The points of a run with their labels, or nothing where they are not to be had.
using ReadPoints = std::function<std::optional<LabelledPoints>(const RunScore&)>;

struct ReportInput {
  const Evaluation& evaluation;
  const GenerationSeconds* generation = nullptr;  ///< maybe empty: compare with the paper; null: don't
  ReadPoints read_points = {};                    ///< for pictures and 3D views; may be empty
  std::vector<std::string> scenes = {};           ///< that are shown beside the worst: "A10/003"
};

/// Throws ConfigError where one of the scenes has no result.
std::string format_html_report(const ReportInput& input);

/// The runs that the report shows: the three worst of each method, at most one a scene.
std::vector<const RunScore*> pictured_runs(const std::vector<RunScore>& runs);

/// Of each of the scenes the worst run of each method. Throws ConfigError where there is none.
std::vector<const RunScore*> runs_of_scenes(const std::vector<RunScore>& runs, const std::vector<std::string>& scenes);

}  // namespace tubebin::evaluation
