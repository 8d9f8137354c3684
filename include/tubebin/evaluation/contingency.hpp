/// How the points of a scene fall into ground-truth segments and predicted segments: all that the metrics
/// need.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tubebin/evaluation/assignment.hpp"

namespace tubebin::evaluation {

/// A segment's name: a label or a colour.
using SegmentId = std::uint32_t;

/// The predicted id of a point that belongs to no tube: label 0 or the null colour.
constexpr SegmentId kNullId = 0;

struct Contingency {
  std::vector<SegmentId> truth_ids;      ///< ascending; one a row
  std::vector<SegmentId> predicted_ids;  ///< ascending, never kNullId; one a column
  Counts counts;                         ///< points of each ground-truth segment in each predicted one
  std::vector<std::int64_t> unlabeled;   ///< points of each ground-truth segment without a predicted one
  std::optional<SegmentId> bin_id;       ///< the ground-truth segment that is the bin, where that is known

  std::int64_t truth_size(std::size_t row) const {
    return counts.row(static_cast<Eigen::Index>(row)).sum() + unlabeled[row];
  }
  std::int64_t predicted_size(std::size_t column) const { return counts.col(static_cast<Eigen::Index>(column)).sum(); }
  std::int64_t count(std::size_t row, std::size_t column) const {
    return counts(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
  }
  std::int64_t total() const;
  bool is_bin(std::size_t row) const { return bin_id && truth_ids[row] == *bin_id; }
  bool operator==(const Contingency&) const = default;
};

/// Throws IoError where there are so many different ids that they can't be segments; `name` is of the file, if any.
void require_segments(std::size_t truth_count, std::size_t predicted_count, const std::string& name = "");

/// Counts the pairs (truth[i], predicted[i]); both have one id a point. Throws IoError where there are so
/// many different ids that they can't be segments.
Contingency count_pairs(std::span<const SegmentId> truth, std::span<const SegmentId> predicted,
                        std::optional<SegmentId> bin_id = std::nullopt);

}  // namespace tubebin::evaluation
