// Randomness that belongs to a pixel of the full image: it depends neither on what part of the image is scanned, nor on
// the order, nor on which other effects are on.
#pragma once

#include <cstdint>
#include <vector>

#include "tubebin/scene/scene.hpp"

namespace tubebin::scan {

/// Every effect draws from a stream of its own.
enum class NoiseStream : std::uint64_t {
  range = 1,
  lateral_x,
  lateral_y,
  signal,
  tube_reflectivity,
  mixed_pixels,
  outlier_choice,
  outlier_depth
};

class PixelNoise {
 public:
  /// `seed` is the scene's.
  PixelNoise(std::uint64_t seed, NoiseStream stream);

  /// Uniform in [0, 1).
  double uniform(int column, int row) const;
  /// Normal with mean 0 and standard deviation 1 (Box-Muller).
  double normal(int column, int row) const;

 private:
  double uniform(int column, int row, std::uint64_t draw) const;

  std::uint64_t seed_;
};

/// One normal of mean 0 and standard deviation 1 for each pixel of the window, row by row. The correlation of pixels at a
/// distance of d pixels is exp(-(d / correlation_length)^2): white noise under a Gaussian filter of standard deviation
/// correlation_length / 2.
std::vector<double> correlated_normals(const PixelNoise& noise, const scene::PixelWindow& window,
                                       double correlation_length);

}  // namespace tubebin::scan
