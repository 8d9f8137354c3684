/// Procedural tubes: Algorithms 1 to 3 of the paper (Section 3).
#pragma once

#include <vector>

#include "tubebin/core/random.hpp"
#include "tubebin/core/yaml.hpp"
#include "tubebin/tube/tube.hpp"

namespace tubebin {

struct TubeOptions {
  double radius = 0.0125;             ///< r, metres
  double length = 0.5;                ///< l, metres
  double cylinder_length_min = 0.02;  ///< cl_min, metres
  int cylinder_count_min = 5;         ///< cn_min
  int cylinder_count_max = 10;        ///< cn_max
  double bend_angle_min_deg = 0.0;    ///< theta_min, degrees
  double bend_angle_max_deg = 30.0;   ///< theta_max, degrees
  double wall_thickness = 0.0;        ///< metres; 0: solid
  double mass = 0.055;                ///< kilograms; the real PVC tubes weigh 0.055, the published simulation took 0.5

  friend bool operator==(const TubeOptions&, const TubeOptions&) = default;
};

/// Names each option's key, limits, unit and effect.
void describe(Fields& fields, TubeOptions& options);
/// Throws ConfigError where options contradict each other; `prefix` is the options' key path.
void check(const TubeOptions& options, const KeyPlaces& places, const std::string& prefix);

/// Algorithm 2: `count` lengths of at least `cylinder_length_min` that sum to `length` (metres).
std::vector<double> generate_lengths(int count, double length, double cylinder_length_min, Random& random);

/// Algorithm 3: endpoints of consecutive cylinders, from the origin, before the random translation
/// (spawning chooses the translation). `lengths.size() + 1` points, metres.
std::vector<Vec3> generate_endpoints(const std::vector<double>& lengths, double bend_angle_min, double bend_angle_max,
                                     Random& random);

/// Algorithm 1: `count` tubes, each in a frame with its first endpoint at the origin.
std::vector<Tube> generate_tubes(int count, const TubeOptions& options, Random& random);

}  // namespace tubebin
