/// The virtual scanner: exact rays of a pinhole camera against exact shapes.
#pragma once

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin {

struct Scan {
  Cloud cloud;         ///< with colours and labels
  PixelWindow window;  ///< the pixels that the cloud covers (an organized cloud has one point a pixel)
  std::vector<std::size_t> tube_pixels;  ///< visible pixels of tube k at [k - 1]
};

/// Scans the scene with its own scanner. Every point lies on the first surface along its pixel's ray
/// (within float32 of the exact position).
Scan scan(const Scene& scene);

/// "3.13.5": the Embree that was compiled in.
const char* embree_version();

}  // namespace tubebin
