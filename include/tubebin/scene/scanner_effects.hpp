/// What tells a real structured-light scanner's cloud from exact rays. Every effect is off by default; formulas and
/// sources are in docs/scanner_effects.md.
#pragma once

#include "tubebin/core/yaml.hpp"

namespace tubebin::scene {

/// Along the ray; grows with the square of the depth and with the incidence angle.
struct RangeNoise {
  double sigma = 0.0;               ///< metres, at the reference distance and head-on; 0: off
  double incidence_gain = 0.0;      ///< growth towards grazing incidence
  double correlation_length = 0.0;  ///< pixels, where the correlation has fallen to 1/e; 0: every pixel for itself
};

/// Light from beside the camera: what it does not reach has no point.
struct ProjectorOptions {
  bool enabled = false;              ///< without one the light comes from the camera
  Vec3 position = {0.15, 0.0, 0.0};  ///< metres, in the scanner's frame
  double focus_distance = 2.0;       ///< metres: where its optical axis meets the camera's
  double horizontal_fov_deg = 75.0;  ///< degrees
  double vertical_fov_deg = 50.0;    ///< degrees
};

/// Too little light comes back, or too much.
struct DropOuts {
  double signal_min = 0.0;             ///< of what a white surface returns head-on at the reference distance; 0: off
  double signal_spread = 0.0;          ///< standard deviation of the logarithm of a pixel's signal
  double tube_reflectivity_min = 1.0;  ///< each tube has its own, uniform in between
  double tube_reflectivity_max = 1.0;
  double bin_reflectivity = 1.0;
  double tube_glare_angle_deg = 0.0;  ///< of the normal from the mirror direction, below which the pixel is too bright
  double bin_glare_angle_deg = 0.0;   ///< 0: off
};

/// Where a pixel's footprint sees two surfaces, its depth is their mean and its label the nearer one's.
struct MixedPixels {
  double share = 0.0;        ///< of the pixels at edges; 0: off
  double footprint = 1.0;    ///< pixels, side of the square that a pixel sees
  double edge_step = 0.005;  ///< metres of depth within the footprint that make an edge
};

/// Points anywhere along their ray.
struct Outliers {
  double share = 0.0;   ///< of all points; 0: off
  double spread = 0.1;  ///< metres, to either side of the surface, uniform
};

/// How the camera that places the points in the world differs from the one that saw them.
struct CalibrationError {
  Vec3 position = Vec3::Zero();      ///< metres, in the scanner's frame
  Vec3 rotation_deg = Vec3::Zero();  ///< about the scanner's x, y and z axes, in that order
  double focal = 0.0;                ///< relative
};

struct ScannerEffects {
  double reference_distance = 1.0;  ///< metres: where noise, quantization and signal have the values given
  RangeNoise range_noise;
  double lateral_noise = 0.0;  ///< pixels, standard deviation along each image axis
  double quantization = 0.0;   ///< metres, depth step at the reference distance
  ProjectorOptions projector;
  DropOuts dropouts;
  MixedPixels mixed_pixels;
  Outliers outliers;
  CalibrationError calibration;

  /// Whether a cloud differs from exact rays.
  bool any() const;
};

void describe(Fields& fields, ScannerEffects& effects);
void check(const ScannerEffects& effects, const KeyPlaces& places, const std::string& prefix);

}  // namespace tubebin::scene
