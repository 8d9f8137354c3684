/// Which point of one cloud stands where a point of another cloud stands.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::evaluation {

/// The point of `reference` that each of `queries` corresponds to, or kNoPoint: equal positions first, then
/// positions that differ by up to `tolerance` (metres) in each coordinate. No point is given out twice; of
/// several points at one position the k-th query gets the k-th. Points with NaN coordinates correspond to
/// none.
std::vector<std::uint32_t> corresponding_points(std::span<const cloud::Point> queries,
                                                std::span<const cloud::Point> reference, float tolerance);

constexpr std::uint32_t kNoPoint = UINT32_MAX;

}  // namespace tubebin::evaluation
