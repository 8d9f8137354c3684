/// Tubes that may be none: edges and corners of other things look like tube here and there.
#pragma once

#include <vector>

#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Drops them: what is short and of little evidence (is_doubtful), and what has a small part of the evidence a point that
/// all tubes of its radius have together; more of those that are short is dropped where some of the ground `is_rough`.
/// Of the common `lengths` (metres) those go that only they had. `labels`: of all points, 0 or 1 + the tube's place. Returns whether
/// any was dropped; the labels are then no longer right.
bool drop_doubtful(std::vector<TubeModel>& tubes, std::vector<double>& lengths, const std::vector<cloud::Label>& labels,
                   bool is_rough);

}  // namespace tubebin::modeling
