#include "modeling/joining/class_joining.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "modeling/joining/branch_joining.hpp"
#include "modeling/joining/tube_joining.hpp"

namespace tubebin::modeling {
namespace {

double length_of(const std::vector<TubePiece>& pieces) {
  double length = 0.0;
  for (const TubePiece& piece : pieces) length += piece.length();
  return length;
}

double longest_path(const std::vector<Joining>& joinings) {
  double longest = 0.0;
  for (const Joining& joining : joinings)
    for (const TubePath& path : joining.paths) longest = std::max(longest, polyline_length(path.nodes));
  return longest;
}

BranchedTubes branches_of(const Joining& joining, double radius, const OcclusionTest& occlusion, double told_length,
                          double longest) {
  const double length = joining.are_copies ? std::ranges::max(joining.lengths) : told_length;
  return joining.tubes_branch ? join_branches(joining.paths, radius, occlusion, length)
                              : join_likely_branches(joining.paths, radius, occlusion, length, longest);
}

/// Keeps ascending lengths that differ by more than what estimates are off, a radius.
void add_lengths(const std::vector<double>& further, double radius, std::vector<double>& lengths) {
  for (const double length : further)
    if (std::ranges::none_of(lengths, [&](double known) { return std::abs(known - length) < radius; }))
      lengths.push_back(length);
  std::ranges::sort(lengths);
}

}  // namespace

std::vector<TubeModel> join_classes(const std::vector<TubeClass>& classes, const OcclusionTest& scan,
                                    const ModelingOptions& options, ModelingResult& result) {
  std::vector<std::vector<Vec3>> told;
  for (const TubeShape& shape : options.tube_shapes) told.push_back(centerline_of(shape));
  if (options.tube_length > 0.0) result.lengths = {options.tube_length};
  std::vector<Joining> joinings;
  double seen = 0.0, explained = 0.0;  // metres
  for (const TubeClass& found : classes) {
    const OcclusionTest occlusion = scan.with_radius(found.radius);
    joinings.push_back(told.empty() ? join_pieces(found.pieces, occlusion, options.tube_length)
                                    : join_pieces_by_shapes(found.pieces, occlusion, told));
    seen += length_of(found.pieces);
    explained += joinings.back().explained * length_of(found.pieces);
  }
  const double longest = longest_path(joinings);
  std::vector<TubeModel> tubes;
  for (std::size_t k = 0; k < classes.size(); ++k) {
    const double radius = classes[k].radius;
    Joining& joining = joinings[k];
    BranchedTubes branched = branches_of(joining, radius, scan.with_radius(radius), options.tube_length, longest);
    std::ranges::move(branched.tubes, std::back_inserter(tubes));
    if (branched.tube_length > 0.0) joining.lengths = {branched.tube_length};
    add_lengths(joining.lengths, radius, result.lengths);
  }
  if (!told.empty() && explained < seen / 2.0)
    result.found.doubts.push_back(
        fmt::format("{:.0f} % of what is seen of tubes lies on copies of the told shape", 100.0 * explained / seen));
  return tubes;
}

}  // namespace tubebin::modeling
