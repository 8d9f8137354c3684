/// The report's first screen: verdict, histogram, worst scenes, table of scenes.
#pragma once

#include <string>

#include "tubebin/evaluation/html_report.hpp"

namespace tubebin::evaluation {

/// In words, with a histogram over the scenes beside them: one block a method.
std::string verdict_html(const Evaluation& evaluation);
/// Pictures and 3D views of the runs' scenes with the reasons.
std::string scenes_html(const ReportInput& input, const std::vector<const RunScore*>& runs);
/// One row a method and scene, the worst first.
std::string scene_table_html(const Evaluation& evaluation);

}  // namespace tubebin::evaluation
