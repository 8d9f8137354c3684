/// A bin that nobody told of.
#pragma once

#include <optional>
#include <span>

#include "modeling/input/background.hpp"
#include "tubebin/modeling/pipeline.hpp"

namespace tubebin::modeling {

constexpr double kLean = 0.26;  ///< of a bin's wall: the sine of 15 degrees

/// The bin whose floor and walls are among the background's regions; of several, that with the most of the foreground's
/// points in it. Walls may lean by 15 degrees. Of two opposite walls one may be hidden, if its upper side is seen. None
/// where floor or other walls are out of sight. `up`: unit, against gravity. `points`: those of the scan.
std::optional<BinFound> find_bin(const Background& background, const Vec3& up, std::span<const cloud::Point> points);

}  // namespace tubebin::modeling
