/// How far a tube goes on beyond the end of its fitted nodes.
#pragma once

#include <span>
#include <vector>

#include "modeling/fitting/loose_points.hpp"
#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {

/// Cosine of 50 degrees: what turns by more within a radius or two is no tube.
constexpr double kSharpTurn = 0.64;

/// Radii, in which points are gathered.
constexpr double kGrowthReach = 6.0;

/// Appends nodes, about a radius apart, as far as the points show that the tube goes on from its last node without a
/// gap, and ends the last cylinder where they end. A point shows it if it lies on the next cylinder's side and its
/// normal stands across it; a flat end's do not.
/// `own` are the cloud's points of the piece, `loose` those of none, about places to kGrowthReach radii.
void grow_end(std::vector<Vec3>& nodes, const FilteredCloud& cloud, std::span<const std::uint32_t> own,
              const LoosePoints& loose, double radius, const Vec3& viewpoint);

}  // namespace tubebin::modeling
