#include "modeling/fitting/centerline_pieces.hpp"

#include <algorithm>

#include "modeling/fitting/branch_splitting.hpp"
#include "modeling/fitting/centerline_fitting.hpp"
#include "modeling/fitting/centerline_segmentation.hpp"
#include "modeling/fitting/end_growth.hpp"
#include "modeling/fitting/flat_ends.hpp"
#include "modeling/fitting/piece_cleaning.hpp"
#include "modeling/input/normals.hpp"
#include "modeling/parallel.hpp"
#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {
namespace {

/// The selected points as a cloud of their own; `source` are their places in `cloud`.
FilteredCloud part_of(const FilteredCloud& cloud, Segment selected, const ViewProjection& projection, double radius) {
  FilteredCloud part{.source = std::move(selected), .points = {}, .normals = {}, .spacing = cloud.spacing};
  for (const std::uint32_t i : part.source) {
    part.points.push_back(cloud.points[i]);
    if (!cloud.viewpoints.empty()) part.viewpoints.push_back(cloud.viewpoints[i]);
  }
  add_normals(part, projection, radius);
  return part;
}

/// What of `rest`, a part of `cloud`, no piece explains.
FilteredCloud still_unexplained(const FilteredCloud& rest, const FilteredCloud& cloud,
                                const std::vector<TubePiece>& pieces, const ViewProjection& projection, double radius) {
  Segment selected;
  for (const std::uint32_t i : unexplained_points(rest.points, pieces, rest.spacing))
    selected.push_back(rest.source[i]);
  return part_of(cloud, std::move(selected), projection, radius);
}

}  // namespace

SegmentCurves find_curves(const FilteredCloud& cloud, std::vector<Segment> segments, double radius) {
  std::vector<Stretch> stretches =
      gather_in_parallel(segments.size(), [&](std::size_t k) { return split_branches(cloud, segments[k], radius); });
  std::vector<VoteCurve> curves = map_in_parallel(
      stretches.size(), [&](std::size_t k) { return find_vote_curve(cloud, std::move(stretches[k]), radius); });
  return {.segments = std::move(segments), .curves = std::move(curves)};
}

std::vector<TubePiece> fit_curves(const FilteredCloud& cloud, const SegmentCurves& found,
                                  const ViewProjection& projection, double radius) {
  const std::vector<VoteCurve>& curves = found.curves;
  const double tolerance = bend_tolerance(curves, radius);
  const LoosePoints loose(cloud, found.segments, kGrowthReach * radius);
  return gather_in_parallel(curves.size(), [&](std::size_t k) {
    const Vec3 viewpoint = viewpoint_of(cloud, curves[k].points, projection);
    auto piece = fit_centerline(cloud, curves[k], tolerance, loose, radius, viewpoint);
    return piece ? cut_where_it_turns_back(std::move(*piece), cloud.points) : std::vector<TubePiece>{};
  });
}

std::vector<TubePiece> find_centerline_pieces(const FilteredCloud& cloud, const SegmentCurves& found,
                                              const ViewProjection& projection, double radius,
                                              const std::function<void(std::vector<VoteCurve>&)>& leave_out) {
  std::vector<TubePiece> pieces = fit_curves(cloud, found, projection, radius);
  drop_explained_pieces(pieces, cloud.points, cloud.spacing);

  FilteredCloud rest = part_of(cloud, unexplained_points(cloud.points, pieces, cloud.spacing), projection, radius);
  fit_flat_ends(pieces, cloud, rest);

  rest = still_unexplained(rest, cloud, pieces, projection, radius);
  SegmentCurves further = find_curves(rest, segment_by_votes(rest, radius), radius);
  leave_out(further.curves);
  for (TubePiece& piece : fit_curves(rest, further, projection, radius)) {
    for (std::uint32_t& i : piece.points) i = rest.source[i];
    pieces.push_back(std::move(piece));
  }
  fit_flat_ends(pieces, cloud, rest);
  cut_overlaps(pieces);
  return pieces;
}

}  // namespace tubebin::modeling
