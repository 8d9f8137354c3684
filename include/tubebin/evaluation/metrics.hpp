/// Measures of a scene's segmentation beside micro-recall. docs/metrics.md defines each one with its source.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "tubebin/evaluation/centerline.hpp"
#include "tubebin/evaluation/micro_recall.hpp"

namespace tubebin::evaluation {

/// IoU thresholds 0.50, 0.55, ..., 0.95 of average precision (Lin et al. 2014, COCO).
constexpr int kIouThresholdCount = 10;
constexpr double iou_threshold(int i) { return 0.5 + 0.05 * i; }

/// The share of a region that must agree in Hoover et al. (1996).
constexpr double kHooverTolerance = 0.8;

/// A ground-truth tube and the segment matched with it by the Hungarian method.
struct TubeScore {
  SegmentId truth_id = 0;
  std::optional<SegmentId> predicted_id;            ///< none: unmatched
  std::int64_t points = 0;                          ///< of the tube
  std::int64_t predicted_points = 0;                ///< of the matched segment
  std::int64_t correct = 0;                         ///< in both
  std::int64_t split = 0;                           ///< of the tube, in other segments that are mostly this tube
  std::int64_t merged = 0;                          ///< of the tube, in segments that are mostly something else
  std::int64_t missed = 0;                          ///< of the tube, in no segment
  std::optional<double> visible_fraction;           ///< of the centreline, where the scene is known
  std::optional<CenterlineError> centerline_error;  ///< where tube and model are known and matched

  double recall() const { return ratio(correct, points); }
  /// 0 for an unmatched tube.
  double precision() const { return ratio(correct, predicted_points); }
  double iou() const { return ratio(correct, points + predicted_points - correct); }

 private:
  static double ratio(std::int64_t part, std::int64_t whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
  }
};

/// Hoover et al. (1996): each tube is detected, over-segmented, under-segmented or missed; a predicted
/// segment with no part in any of the first three is noise.
struct HooverCounts {
  int detected = 0;
  int over_segmented = 0;
  int under_segmented = 0;
  int missed = 0;
  int noise = 0;
};

/// Scores of some tubes of one scene, in a form that can be summed over scenes.
struct SegmentationScores {
  std::int64_t points = 0;                               ///< of these tubes
  std::int64_t correct = 0;                              ///< of these, labelled as the matching says
  std::int64_t background = 0;                           ///< points of the bin in these tubes' segments
  std::vector<TubeScore> tubes;                          ///< that have points in the filtered cloud
  int predicted_tubes = 0;                               ///< predicted segments that belong to these tubes
  std::array<int, kIouThresholdCount> true_positives{};  ///< pairs with an IoU above each threshold
  double true_positive_iou = 0.0;                        ///< sum over the pairs with an IoU above 0.5
  double adjusted_rand_index = 1.0;
  HooverCounts hoover;
};

/// Scores of all tubes (the bin is none). Every predicted segment belongs to them.
SegmentationScores score_tubes(const Contingency& contingency, const Matching& matching);

/// Scores of the tubes of the rows where `selected` is true alone. A predicted segment belongs to them if the
/// tube that has most of its points is one of them.
SegmentationScores score_tubes(const Contingency& contingency, const Matching& matching,
                               const std::vector<bool>& selected);

/// Kirillov et al. 2019: the sum of IoUs over true positives, divided by TP + FP / 2 + FN / 2.
double panoptic_quality(int tubes, int predicted, int true_positives, double true_positive_iou);

/// Area under the precision-recall curve of predictions that have no confidence, so that the curve is one
/// step: precision times recall.
double average_precision(int tubes, int predicted, int true_positives);

/// Hubert & Arabie 1985; 1 where both partitions are trivial.
double adjusted_rand_index(const Counts& counts);

}  // namespace tubebin::evaluation
