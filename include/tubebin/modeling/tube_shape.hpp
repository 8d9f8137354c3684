/// The shape of a kind of part, told as tube benders and CAD have it: length, rotation and angle (LRA), stretch by stretch.
#pragma once

#include <string>
#include <vector>

#include "tubebin/core/geometry.hpp"
#include "tubebin/core/yaml.hpp"

namespace tubebin::modeling {

/// A straight stretch, and the bend that follows it.
struct TubeStretch {
  double length = 0.1;        ///< metres, to where the bend begins
  double bend_deg = 0.0;      ///< by which the tube turns; 0 after the last stretch
  double rotation_deg = 0.0;  ///< of the bend's plane about the stretch, right-handed, from that of the bend before
};

struct TubeShape {
  std::vector<TubeStretch> stretches;
  double bend_radius = 0.0;  ///< metres, of the centreline in its bends; 0: they are corners
};

void describe(Fields& fields, TubeStretch& stretch);
void describe(Fields& fields, TubeShape& shape);

/// Throws ConfigError where stretches and bends do not make a bent tube.
void check(const TubeShape& shape, const KeyPlaces& places, const std::string& prefix);

/// From "length,bend,length,...", a bend as "90" or "90@45" where its plane is rotated by 45 degrees. Throws ConfigError
/// where the text does not have this form; `check` and the limits of `describe` know of values.
TubeShape parse_tube_shape(const std::string& text);

/// Nodes of the centreline, metres, from the origin along x and first bent toward y. The chords of a bend turn by 10 degrees
/// at most.
std::vector<Vec3> centerline_of(const TubeShape& shape);

}  // namespace tubebin::modeling
