/// Steps 2 and 3 of `--method centerline`, in two rounds: what the first round's pieces leave unexplained (slivers
/// beside occluders, stretches at crossings) gets normals of its own, unmixed with its neighbours', and makes the
/// second's.
#pragma once

#include <functional>
#include <vector>

#include "modeling/fitting/vote_curve.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

struct SegmentCurves {
  std::vector<Segment> segments;
  std::vector<VoteCurve> curves;  ///< of all their stretches, or of those that are to be fitted
};

SegmentCurves find_curves(const FilteredCloud& cloud, std::vector<Segment> segments, double radius);

/// One round's.
std::vector<TubePiece> fit_curves(const FilteredCloud& cloud, const SegmentCurves& found,
                                  const ViewProjection& projection, double radius);

/// Both rounds', the second's of those curves that `leave_out` leaves.
std::vector<TubePiece> find_centerline_pieces(const FilteredCloud& cloud, const SegmentCurves& found,
                                              const ViewProjection& projection, double radius,
                                              const std::function<void(std::vector<VoteCurve>&)>& leave_out);

}  // namespace tubebin::modeling
