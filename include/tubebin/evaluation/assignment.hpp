/// Maximum-weight unbalanced assignment in a bipartite graph (paper, Section 5), by the Hungarian method.
#pragma once

#include <cstdint>
#include <vector>

#include "tubebin/core/geometry.hpp"

namespace tubebin::evaluation {

/// Numbers of points, one row a ground-truth segment and one column a predicted segment.
using Counts = Eigen::Matrix<std::int64_t, Eigen::Dynamic, Eigen::Dynamic>;

constexpr int kUnmatched = -1;

/// The column that each row is matched with, or kUnmatched: no column is taken twice, and the sum of the
/// matched weights is the largest possible. `weights` are non-negative and may have more rows or more
/// columns; a pair of weight zero stays unmatched. O(s^2 l) for the smaller side s and the larger side l.
std::vector<int> max_weight_assignment(const Counts& weights);

}  // namespace tubebin::evaluation
