/// Centrelines by samples at equal steps, and how one lies on another.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tubebin/core/geometry.hpp"

namespace tubebin::modeling {

/// Places at equal steps, as near to `step` metres as the length allows, from the polyline's first node to its last. Each is
/// a mean over `reach` metres to either side: nodes that were fitted to a rough surface scatter about the centreline.
std::vector<Vec3> smooth_samples(const std::vector<Vec3>& nodes, double step, double reach);

/// The farthest that a curve comes from the chord of its ends, metres.
double sagitta(std::span<const Vec3> samples);

/// The rigid motion that brings `from` nearest to `to`, place by place (Umeyama 1991, "Least-squares estimation of
/// transformation parameters between two point patterns"). As many of both, at least one.
Pose best_motion(std::span<const Vec3> from, std::span<const Vec3> to);

/// Of the pairs once `motion` has brought `from` to `to`, square metres.
double mean_squared_distance(std::span<const Vec3> from, std::span<const Vec3> to, const Pose& motion);

/// Root mean square, metres, of the distances of `from` from the polyline `to` once `motion` has brought it there, sample k
/// to about the place of sample `first` + k, and iterative closest points (Besl and McKay 1992) nearer still.
double distance_apart(std::span<const Vec3> from, std::span<const Vec3> to, std::ptrdiff_t first, Pose motion);

}  // namespace tubebin::modeling
