/// Random paths of cylinders: Algorithms 2 and 3 of the paper (Section 3). A chain is one path, a tree is several.
#pragma once

#include <vector>

#include "tubebin/core/random.hpp"
#include "tubebin/core/yaml.hpp"
#include "tubebin/tube/tube.hpp"

namespace tubebin::tube {

struct PathOptions {
  double length = 0.5;                ///< l, metres
  double cylinder_length_min = 0.02;  ///< cl_min, metres
  int cylinder_count_min = 5;         ///< cn_min
  int cylinder_count_max = 10;        ///< cn_max
  double bend_angle_min_deg = 0.0;    ///< theta_min, degrees
  double bend_angle_max_deg = 30.0;   ///< theta_max, degrees
};

/// Names each option's key, limits, unit and effect.
void describe(Fields& fields, PathOptions& options);
/// Throws ConfigError where options contradict each other; `prefix` is the options' key path.
void check(const PathOptions& options, const KeyPlaces& places, const std::string& prefix);

/// Throws ConfigError where a path's end may be nearer than the radius to a joint, whose sphere then closes the opening of
/// a hollow tube.
void check_open_ends(const PathOptions& options, double radius, double wall_thickness, const KeyPlaces& places,
                     const std::string& prefix);

/// Algorithm 2: `count` lengths of at least `cylinder_length_min` that sum to `length` (metres).
std::vector<double> generate_lengths(int count, double length, double cylinder_length_min, Random& random);

/// Algorithm 3: endpoints of consecutive cylinders, from the origin, before the random translation
/// (spawning chooses the translation). `lengths.size() + 1` points, metres.
std::vector<Vec3> generate_endpoints(const std::vector<double>& lengths, double bend_angle_min, double bend_angle_max,
                                     Random& random);

/// The body of Algorithm 1: a random number of cylinders, their lengths and their endpoints, from the origin.
std::vector<Vec3> generate_path(const PathOptions& options, Random& random);

/// Turns `vector` as the rotation does that takes +z to the unit vector `direction` about their cross product
/// (Algorithm 3, line 11).
Vec3 rotate_from_z_to(const Vec3& direction, const Vec3& vector);

/// The unit vector with polar angle theta from +z and azimuth phi, radians.
Vec3 spherical(double theta, double phi);

/// Joins the nodes by cylinders, each with the next. The first of `nodes` is that of index `start`, which the tube has
/// already; the others are added. Orders count from 0.
void append_path(int start, const std::vector<Vec3>& nodes, Tube& tube);

}  // namespace tubebin::tube
