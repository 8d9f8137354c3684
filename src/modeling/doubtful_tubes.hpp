/// Tubes that may be none: edges and folds of other things look like tube here and there.
#pragma once

#include <cstdint>
#include <vector>

#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// A tube that has a small part of the evidence a point that all tubes of its radius have together: an edge of something, a bit of
/// another tube's surface, or a tube that is nearly hidden.
struct WeakTube {
  TubeModel tube;
  std::vector<std::uint32_t> points;  ///< places of those labelled as its
};

/// Takes out what is short and of little evidence (is_doubtful) and what is weak; returns those of the weak whose points say more than
/// a nat each, but none where some of the ground `is_rough`. `labels`: of the points, 0 or 1 + the tube's place; right no longer where
/// a tube is gone. Of the common `lengths` (metres) those go that only dropped tubes had.
std::vector<WeakTube> drop_doubtful(std::vector<TubeModel>& tubes, std::vector<double>& lengths,
                                    const std::vector<cloud::Label>& labels, bool is_rough);

/// Appends those again most of whose points are no other tube's by the `labels` since. Returns whether there were any.
bool restore_unexplained(const std::vector<WeakTube>& weak, std::vector<TubeModel>& tubes, std::vector<double>& lengths,
                         const std::vector<cloud::Label>& labels);

}  // namespace tubebin::modeling
