/// How a method did on each scene, and why points are wrong.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tubebin/evaluation/evaluation.hpp"

namespace tubebin::evaluation {

/// Why points are wrong.
enum class Reason { split, merged, missed, background };

/// Numbers of wrong points, each counted once.
struct Losses {
  std::int64_t split = 0;       ///< in a further segment of their tube
  std::int64_t merged = 0;      ///< in a segment that is mostly another tube, or mostly background
  std::int64_t missed = 0;      ///< in no segment
  std::int64_t background = 0;  ///< of the bin, in a segment

  std::int64_t of(Reason reason) const;
  std::int64_t total() const { return split + merged + missed + background; }
};

Losses losses(const SegmentationScores& scores);
Losses operator+(const Losses& a, const Losses& b);

/// All runs of a method on a scene: one at each ratio.
struct SceneSummary {
  std::string method;
  std::string scene;
  int tubes = 0;
  double micro_recall = 0.0;  ///< mean over the runs
  double detected = 0.0;      ///< share of the tubes, mean over the runs
  Losses lost;                ///< of all runs together
  const RunScore* worst = nullptr;
};

/// By method, then the lowest micro-recall first.
std::vector<SceneSummary> summarize_scenes(std::span<const RunScore> runs);

/// The reasons in a few words, most points first: "split, missed"; "-" where no point is wrong. Reasons with less
/// than a tenth of the wrong points are left out.
std::string reasons_text(const Losses& lost);

/// What became of the tubes that lost more than a fifth of their points, or that none did: "Tube 4 is split. Tubes 2
/// and 7 are merged with others."
std::string describe_errors(const RunScore& run);

}  // namespace tubebin::evaluation
