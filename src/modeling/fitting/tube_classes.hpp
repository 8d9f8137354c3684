/// The radii of the scene's tubes, and the pieces of each.
#pragma once

#include <vector>

#include "modeling/input/radius_estimation.hpp"
#include "modeling/joining/occlusion.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Pieces of tubes of one radius.
struct TubeClass {
  double radius = 0.0;        ///< metres
  double radius_error = 0.0;  ///< metres, standard deviation; 0 where the radius was told
  std::vector<TubePiece> pieces;
};

struct TubeClasses {
  std::vector<TubeClass> classes;
  std::vector<TubePiece> wires;   ///< of a mesh (wire_mesh.hpp)
  std::vector<RoundPlace> round;  ///< of all of the cloud; none where radii are told, and all is tubes of these
  bool on_rough_ground = false;   ///< some of the ground is rough
};

/// Finds the pieces of tubes of each radius, the commonest first: the `told` radii (metres), or, where none is told, those
/// that the surface's curvature shows, until what is left shows none. `noise`:
/// metres, of the points across a surface; 0 where it is not known. `background_is_known`: pieces of the first radius need
/// no proof that they are of tubes, and go only where they are clearly of another radius. `up`: unit, against gravity; zero
/// where it is not known.
TubeClasses find_tube_classes(const FilteredCloud& cloud, const ViewProjection& projection,
                              const OcclusionTest& occlusion, double noise, bool background_is_known, const Vec3& up,
                              const std::vector<double>& told);

}  // namespace tubebin::modeling
