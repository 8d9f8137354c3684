/// Cloth, gravel, ribs: ground that is as round as a tube here and there.
#pragma once

#include <cstddef>
#include <vector>

#include "modeling/fitting/vote_curve.hpp"
#include "modeling/joining/occlusion.hpp"

namespace tubebin::modeling {

/// Points r / 6 apart: twenty tubes, forty radii long, have fewer. Real scans round their edges, and most of a few rods' outlines are
/// lost: so little is no rough ground.
constexpr std::size_t kPointsOfGround = 50'000;

/// For each curve, whether the surface goes on beside a tube about it.
std::vector<char> find_ground(const std::vector<VoteCurve>& curves, double radius, const OcclusionTest& occlusion);

/// Whether the ground is rough: of the `sampled` points of what is not flat, which are many, most are on no curve but those of the
/// ground.
bool is_rough(const std::vector<VoteCurve>& curves, const std::vector<char>& is_ground, std::size_t sampled);

void drop_ground(std::vector<VoteCurve>& curves, const std::vector<char>& is_ground);

/// Drops the curves of the ground where it is rough; whether it is.
bool drop_rough_ground(std::vector<VoteCurve>& curves, std::size_t sampled, double radius,
                       const OcclusionTest& occlusion);

}  // namespace tubebin::modeling
