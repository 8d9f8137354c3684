/// The scores of one run: one cloud, modelled by one method at one downsampling ratio.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tubebin/evaluation/metrics.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::evaluation {

/// Tubes are told apart by the visible share of their centreline: [0, 1/4), [1/4, 1/2), [1/2, 3/4), [3/4, 1].
constexpr int kVisibilityClasses = 4;
/// "0-25 %", ...
const char* visibility_class_name(int visibility_class);

struct RunKey {
  std::string scene;    ///< "A10/007"
  std::string set;      ///< "A"
  int tubes = 0;        ///< in the scene
  int case_number = 0;  ///< from 1
  std::string method;
  double ratio = 1.0;  ///< of the downsampling filter

  /// "A10/007 centerline 0.3".
  std::string name() const;
};

/// The set, number of tubes and case that a scene's name tells: "A10/007" is set A, ten tubes, case 7, and
/// "A1/12000/12345" case 12345. Where
/// it has another form, the set is its first folder and the other two are 0.
RunKey parse_scene_name(const std::string& name);

/// What is known of a scene's tubes beyond the labels of its points; tube k is at [k - 1].
struct SceneTruth {
  explicit SceneTruth(const scene::Scene& scene);

  std::vector<Centerline> centerlines;
  std::vector<CenterlineSamples> samples;
};

struct RunScore {
  RunKey key;
  bool failed = false;        ///< the algorithm gave no result, which counts as zero
  double micro_recall = 0.0;  ///< Equation 1
  SegmentationScores scores;
  std::vector<SegmentationScores> by_visibility;  ///< kVisibilityClasses of them; empty where the scene is not known
  std::optional<double> coverage;                 ///< share of the scene's tube points that were scored; nothing: all
  std::optional<double> seconds;                  ///< modelling time
  std::string dataset;                            ///< the data set's folder; empty where the scene is not known
  std::string folder;                             ///< of a run of model_tubes
  std::string filtered;                           ///< files of the clouds; empty where they were not kept
  std::string labeled;
};

/// `matching` is of `contingency`, whose ground-truth ids are labels. `truth` is null where the scene is not
/// known, `model` empty where there are no centrelines; the model tube of predicted id k is model[k - 1].
RunScore score_run(const RunKey& key, const Contingency& contingency, const Matching& matching, const SceneTruth* truth,
                   const std::vector<Centerline>& model);

}  // namespace tubebin::evaluation
