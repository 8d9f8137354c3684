#include "tubebin/modeling/centerline_pieces.hpp"

#include "tubebin/modeling/centerline_fitting.hpp"
#include "tubebin/modeling/centerline_segmentation.hpp"
#include "tubebin/modeling/flat_ends.hpp"
#include "tubebin/modeling/piece_cleaning.hpp"
#include "tubebin/modeling/view_grid.hpp"

namespace tubebin {
namespace {

/// The points that no segment holds.
Segment loose_points(std::size_t count, const std::vector<Segment>& segments) {
  std::vector<bool> is_held(count, false);
  for (const Segment& segment : segments)
    for (const std::uint32_t i : segment) is_held[i] = true;
  Segment loose;
  for (std::uint32_t i = 0; i < count; ++i)
    if (!is_held[i]) loose.push_back(i);
  return loose;
}

std::vector<TubePiece> fit_segments(const FilteredCloud& cloud, const std::vector<Segment>& segments,
                                    const ViewProjection& projection, double radius) {
  const Segment loose = loose_points(cloud.points.size(), segments);
  const Vec3 viewpoint = projection.viewpoint().cast<double>();
  std::vector<TubePiece> pieces;
  for (const Segment& segment : segments)
    if (auto piece = fit_centerline(cloud, segment, loose, radius, viewpoint)) pieces.push_back(std::move(*piece));
  return pieces;
}

/// The selected points as a cloud of their own.
FilteredCloud part_of(const FilteredCloud& cloud, const Segment& selected, const ViewProjection& projection,
                      double radius) {
  FilteredCloud part{.source = {}, .points = {}, .normals = {}, .spacing = cloud.spacing};
  for (const std::uint32_t i : selected) part.points.push_back(cloud.points[i]);
  part.normals = estimate_normals(projection, part.points, normal_radius(cloud.spacing, radius));
  return part;
}

}  // namespace

std::vector<TubePiece> find_centerline_pieces(const FilteredCloud& cloud, const std::vector<Segment>& segments,
                                              const ViewProjection& projection, double radius) {
  std::vector<TubePiece> pieces = fit_segments(cloud, segments, projection, radius);
  drop_explained_pieces(pieces, cloud.points, cloud.spacing);

  Segment unexplained = unexplained_points(cloud.points, pieces, cloud.spacing);
  FilteredCloud rest = part_of(cloud, unexplained, projection, radius);
  fit_flat_ends(pieces, cloud, rest);

  unexplained = unexplained_points(cloud.points, pieces, cloud.spacing);
  rest = part_of(cloud, unexplained, projection, radius);
  for (TubePiece& piece : fit_segments(rest, segment_by_votes(rest, radius), projection, radius)) {
    for (std::uint32_t& i : piece.points) i = unexplained[i];
    pieces.push_back(std::move(piece));
  }
  fit_flat_ends(pieces, cloud, rest);
  cut_overlaps(pieces);
  return pieces;
}

}  // namespace tubebin
