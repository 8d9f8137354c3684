/// A first centreline of a stretch: where its surface's normals put it.
#pragma once

#include <span>
#include <vector>

#include "modeling/fitting/branch_splitting.hpp"
#include "modeling/fitting/surface_fitting.hpp"
#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {

/// A surface point's normal and where it puts the centreline.
struct Vote {
  Vec3 normal;
  Vec3 center;
  std::size_t sample = 0;  ///< nearest sample of the curve
  double arclength = 0.0;  ///< along the curve, metres
};

struct VoteCurve {
  Segment points;                     ///< of the stretch
  std::vector<SurfacePoint> surface;  ///< those of them that vote
  std::vector<Vote> votes;            ///< theirs
  std::vector<Vec3> samples;          ///< of the curve, a third of a radius apart, but for its ends; metres
};

VoteCurve find_vote_curve(const FilteredCloud& cloud, Stretch stretch, double radius);

/// How far curves' samples scatter about them, metres, standard deviation an axis: as noise of the scan makes it.
double roughness(std::span<const VoteCurve> curves);

}  // namespace tubebin::modeling
