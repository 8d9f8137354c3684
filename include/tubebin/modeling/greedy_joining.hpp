/// Joining of `--method region_growing`: the paper's step 4, as its predecessor (Leao et al. 2019) describes it.
#pragma once

#include <vector>

#include "tubebin/core/yaml.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

struct GreedyJoiningOptions {
  double gap_max = 0.1;         ///< metres between two endpoints
  double angle_max_deg = 60.0;  ///< between each axis and the line that joins the endpoints
  double angle_cost = 0.002;    ///< metres a degree
  double length_max = 0.6;      ///< metres, of a whole tube; the tubes' 0.5 and what the estimates are off
};

void describe(Fields& fields, GreedyJoiningOptions& options);

/// Joins endpoints of distinct tubes in order of increasing cost, distance + angle_cost * angle, where the angle is the
/// sum of those between each axis and the line between the endpoints, and both are under their thresholds. Every
/// endpoint is joined once at most.
std::vector<TubeModel> join_greedily(const std::vector<TubePiece>& pieces, const GreedyJoiningOptions& options);

}  // namespace tubebin::modeling
