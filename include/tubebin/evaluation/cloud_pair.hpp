/// A filtered cloud (ground truth) and a labelled cloud (prediction), brought together point by point.
#pragma once

#include <string>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/evaluation/contingency.hpp"

namespace tubebin::evaluation {

/// What tells the segments of a cloud apart.
enum class SegmentField { automatic, label, color };

/// A cloud and the name that messages call it by.
struct NamedCloud {
  const cloud::Cloud& cloud;
  std::string name;
};

/// Ids of the points that have a position and a ground truth, in the filtered cloud's order.
struct PairedIds {
  std::vector<std::uint32_t> points;  ///< index in the filtered cloud
  std::vector<SegmentId> truth;       ///< label (0 = bin) or colour
  std::vector<SegmentId> predicted;   ///< label or colour; kNullId also where the labelled cloud lacks the point
  std::optional<SegmentId> bin_id;    ///< of `truth`; colours alone do not tell which is the bin's
  bool truth_is_color = false;
  bool predicted_is_color = false;
  std::size_t missing = 0;      ///< points of the filtered cloud that the labelled cloud lacks
  std::size_t unannotated = 0;  ///< points of the filtered cloud in the null colour: no ground truth, left out
};

/// Matches the clouds by position: the labelled cloud has the filtered cloud's points in any order, or a
/// subset of them. Positions may differ by kPositionTolerance, as text formats round them; of several points
/// at one position the k-th of one cloud belongs to the k-th of the other. Points with NaN coordinates are
/// left out.
///
/// `automatic` takes a cloud's labels where it has them, else its colours; where a cloud has both and they do
/// not say the same, that is an error which `field` resolves. Throws IoError where a labelled point is at no
/// point of the filtered cloud, where a cloud has neither labels nor colours (or not those that `field`
/// names), or no points.
PairedIds pair_clouds(const NamedCloud& filtered, const NamedCloud& labeled,
                      SegmentField field = SegmentField::automatic);

/// Metres. Far below the distance of neighbouring points, far above the rounding of five decimals.
constexpr float kPositionTolerance = 1e-5F;

}  // namespace tubebin::evaluation
