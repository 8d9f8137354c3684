/// Whether a piece is a stretch of tube, or something else that cylinders happen to fit.
#pragma once

#include <span>

#include "modeling/joining/occlusion.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// What the points of a piece and the scan about it say of its surface.
struct PieceEvidence {
  double curvature = 0.0;        ///< across the axis, in units of 1 / radius: 1 on a tube of this radius, 0 on a plane
  double curvature_error = 0.0;  ///< its standard deviation
  double sigma = 0.0;            ///< metres, of the points' distances to the best surface of any curvature
  double surface = 0.0;          ///< part of its visible sides where the scanner measured a surface
  double empty = 0.0;            ///< part of them where it saw through, and so no tube is
  OutlineEvidence outline;       ///< on average over its length
  double coiled = 0.0;           ///< part of its length within a radius of another place of its centreline
};

/// On average along a centreline.
OutlineEvidence outline_along(std::span<const Vec3> nodes, double radius, const OcclusionTest& occlusion);

/// `cloud` has the piece's points, with normals.
PieceEvidence examine_piece(const TubePiece& piece, const FilteredCloud& cloud, const OcclusionTest& occlusion);

/// Whether the points are clearly of another curvature than a tube's of this radius.
bool has_other_radius(const PieceEvidence& evidence);

/// Whether the surface goes on beyond the tube's outline more than it ends there, as the fold of a cloth or a wave of rough ground
/// does. So does a tube in a close row that is seen obliquely.
bool goes_on_beside(const OutlineEvidence& outline);

/// Whether the surroundings go on at the height of their axes beside all of a radius' pieces, as beside ribs, beads and rounded edges.
/// Of tubes, those along walls or other tubes alone look so, up to a quarter of their places.
bool are_sunk(const OutlineEvidence& outline);

/// Whether a tube explains the evidence better than any flat strip or chance: curved like a tube of this radius, as far
/// as the points can tell, with points on its surface and no sides that the scanner saw through.
bool is_tube(const PieceEvidence& evidence, double radius, double noise);

/// In radii: necks and caps of bottles, edges, corners and points in the air may look like shorter tubes.
constexpr double kShort = 8.0;

/// Edges and corners of other things look like a short stretch of tube, too, but of a worse surface. Metres; nats.
bool is_doubtful(double length, double radius, double evidence);

/// Whether the piece is straight and upright: tubes lie or lean, and bottles, columns and the edges of boxes stand. `up`:
/// unit, or zero where it is not known, and nothing stands.
bool stands_upright(const TubePiece& piece, const Vec3& up);

/// Whether one of the `ends` of pieces that do not stand is where the upright piece ends: a bottle or a column does not go on.
bool goes_on(const TubePiece& upright, const std::vector<Vec3>& ends);

/// Whether most of the piece's centreline runs nearer to another one than a radius, the larger of the two: both solids can't
/// be there. That of a streak along a bottle does.
bool is_inside(const TubePiece& piece, const TubePiece& solid);

}  // namespace tubebin::modeling
