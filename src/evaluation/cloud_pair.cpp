#include "tubebin/evaluation/cloud_pair.hpp"

#include <algorithm>
#include <unordered_map>

#include "evaluation/position_index.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::evaluation {
namespace {

/// Whether equal labels mean equal colours and the other way round; else the first point where they do not.
std::optional<std::size_t> first_disagreement(const cloud::Cloud& cloud) {
  std::unordered_map<cloud::Label, cloud::Color> color_of_label;
  std::unordered_map<cloud::Color, cloud::Label> label_of_color;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const cloud::Label label = cloud.labels[i];
    const cloud::Color color = cloud.colors[i];
    const bool repeats = i > 0 && label == cloud.labels[i - 1] && color == cloud.colors[i - 1];
    if (repeats || !cloud::is_finite(cloud.points[i])) continue;
    if (color_of_label.try_emplace(label, color).first->second != color ||
        label_of_color.try_emplace(color, label).first->second != label)
      return i;
  }
  return std::nullopt;
}

SegmentField automatic_field(const NamedCloud& named) {
  const cloud::Cloud& cloud = named.cloud;
  if (cloud.labels.empty() && cloud.colors.empty())
    throw_io_error("{}: has neither a label field nor colours, so it names no tubes", named.name);
  if (cloud.labels.empty()) return SegmentField::color;
  if (cloud.colors.empty()) return SegmentField::label;
  if (const auto point = first_disagreement(cloud))
    throw_io_error(
        "{}: its labels and its colours do not tell the same segments apart (point {}: label {}, colour "
        "#{:06x}); "
        "choose one with --field label or --field color",
        named.name, *point, cloud.labels[*point], cloud.colors[*point]);
  return SegmentField::label;
}

SegmentField resolve_field(const NamedCloud& named, SegmentField field) {
  if (named.cloud.size() == 0) return SegmentField::label;  // a cloud without points has no need of ids
  if (field == SegmentField::automatic) return automatic_field(named);
  if (field == SegmentField::label && named.cloud.labels.empty()) throw_io_error("{}: has no label field", named.name);
  if (field == SegmentField::color && named.cloud.colors.empty()) throw_io_error("{}: has no colours", named.name);
  return field;
}

const std::vector<SegmentId>& ids_of(const cloud::Cloud& cloud, SegmentField field) {
  return field == SegmentField::label ? cloud.labels : cloud.colors;
}

void require_points(const NamedCloud& named) {
  if (std::none_of(named.cloud.points.begin(), named.cloud.points.end(), cloud::is_finite))
    throw_io_error("{}: has no point with a position", named.name);
}

/// Predicted ids in the filtered cloud's order; `found` tells which points the labelled cloud has.
std::vector<SegmentId> predicted_ids(const NamedCloud& filtered, const NamedCloud& labeled, SegmentField field,
                                     std::vector<char>& found) {
  const std::vector<std::uint32_t> point_of =
      corresponding_points(labeled.cloud.points, filtered.cloud.points, kPositionTolerance);
  const std::vector<SegmentId>& ids = ids_of(labeled.cloud, field);
  std::vector<SegmentId> predicted(filtered.cloud.size(), kNullId);
  std::size_t strangers = 0;
  std::size_t first_stranger = 0;
  for (std::size_t i = 0; i < point_of.size(); ++i) {
    if (point_of[i] != kNoPoint) {
      predicted[point_of[i]] = ids[i];
      found[point_of[i]] = 1;
    } else if (cloud::is_finite(labeled.cloud.points[i]) && strangers++ == 0) {
      first_stranger = i;
    }
  }
  if (strangers > 0) {
    const cloud::Point& p = labeled.cloud.points[first_stranger];
    throw_io_error(
        "{}: {} of its {} points are at no point of {} (the first is point {} at {} {} {} m); a labelled "
        "cloud has "
        "points of the filtered cloud alone",
        labeled.name, strangers, labeled.cloud.size(), filtered.name, first_stranger, p.x(), p.y(), p.z());
  }
  return predicted;
}

}  // namespace

PairedIds pair_clouds(const NamedCloud& filtered, const NamedCloud& labeled, SegmentField field) {
  require_points(filtered);
  const SegmentField truth_field = resolve_field(filtered, field);
  const SegmentField predicted_field = resolve_field(labeled, field);
  std::vector<char> found(filtered.cloud.size(), 0);
  const std::vector<SegmentId> predicted = predicted_ids(filtered, labeled, predicted_field, found);
  const std::vector<SegmentId>& truth = ids_of(filtered.cloud, truth_field);

  PairedIds pairs;
  pairs.truth_is_color = truth_field == SegmentField::color;
  pairs.predicted_is_color = predicted_field == SegmentField::color;
  if (truth_field == SegmentField::label) pairs.bin_id = 0;
  pairs.truth.reserve(truth.size());
  pairs.predicted.reserve(truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!cloud::is_finite(filtered.cloud.points[i])) continue;
    if (truth_field == SegmentField::color && truth[i] == cloud::kNullColor) {
      ++pairs.unannotated;
      continue;
    }
    pairs.points.push_back(static_cast<std::uint32_t>(i));
    pairs.truth.push_back(truth[i]);
    pairs.predicted.push_back(predicted[i]);
    pairs.missing += found[i] ? 0 : 1;
  }
  if (pairs.truth.empty())
    throw_io_error("{}: every point has the null colour, so there is no ground truth", filtered.name);
  return pairs;
}

}  // namespace tubebin::evaluation
