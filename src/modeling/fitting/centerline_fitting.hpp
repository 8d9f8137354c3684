/// Cylinder fitting of `--method centerline` (step 3 of the pipeline).
#pragma once

#include <optional>
#include <span>

#include "modeling/fitting/loose_points.hpp"
#include "modeling/fitting/vote_curve.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// How far a curve may be off the chords that replace it, metres: as far as noise leads it astray, four standard deviations
/// of what scatters the scene's curves.
double bend_tolerance(std::span<const VoteCurve> curves, double radius);

/// Nodes of cylinders along the curve, before points are fitted: it is cut where it bends by more than the `tolerance` (metres).
std::vector<Vec3> first_nodes(const VoteCurve& votes, double tolerance, double radius);

/// Fits consecutive cylinders of the known radius to a stretch: its curve is cut where it bends by more than the `tolerance`
/// (metres), the nodes minimize the points' distances to the surface, and the ends grow as far as points show them, also
/// those `loose` ones that no segment holds. Nothing results from votes that are no tube's.
std::optional<TubePiece> fit_centerline(const FilteredCloud& cloud, const VoteCurve& votes, double tolerance,
                                        const LoosePoints& loose, double radius, const Vec3& viewpoint);

/// A piece that turns back goes over from one tube to another, or runs twice along one: its parts, each with the points that
/// are nearest to it. A single loop, which the end of another tube makes, goes.
std::vector<TubePiece> cut_where_it_turns_back(TubePiece piece, std::span<const cloud::Point> points);

}  // namespace tubebin::modeling
