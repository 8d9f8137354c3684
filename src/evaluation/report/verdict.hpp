/// A method's results in words: how good, how sure, where it fails.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "evaluation/report/scene_summary.hpp"

namespace tubebin::evaluation {

struct VerdictText {
  std::string headline;        ///< "centerline finds nearly every tube"
  std::string how_good;        ///< shares of tubes and points
  std::string how_sure;        ///< the interval over scenes of the mean micro-recall
  std::string where_it_fails;  ///< reasons and the worst conditions
};

/// `runs` are all of one method, at least one; `scenes` are summarize_scenes() of them.
VerdictText describe_results(std::span<const RunScore* const> runs, std::span<const SceneSummary> scenes);

}  // namespace tubebin::evaluation
