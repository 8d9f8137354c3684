/// The virtual scanner: exact rays of a pinhole camera against exact shapes, and what a real scanner makes of them.
#pragma once

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::scan {

struct Scan {
  cloud::Cloud cloud;         ///< with colours and labels
  scene::PixelWindow window;  ///< the pixels that the cloud covers (an organized cloud has one point a pixel)
  std::vector<std::size_t> tube_pixels;  ///< pixels that have a point of tube k at [k - 1]
};

/// Scans the scene with its own scanner. Without effects (scene.scanner.effects) every point lies on the first surface
/// along its pixel's ray (within float32 of the exact position), whatever the seed. With effects `seed`, the scene's,
/// decides all randomness, the same for a pixel in every region.
///
/// `bin_alone`, which scan_bin_alone() made of the same bin and scanner, makes scans of several piles in one bin faster:
/// exact rays that can meet no tube are not traced anew. The result is the same.
Scan scan(const scene::Scene& scene, std::uint64_t seed = 0, const Scan& bin_alone = {});

/// What all of the scene's scanners see, each with its own effects and noise. Of one scanner it is scan(). Of several it is
/// one unorganized cloud: the points of source 0, then those of source 1 and so on, each with its source; `tube_pixels` are
/// those of all, `window` is source 0's. Source 0's points are those that it would have alone.
struct MergedScan : Scan {
  std::vector<scene::PixelWindow> further_windows;
};
/// `bins_alone`: as above, of each scanner; or empty.
MergedScan scan_from_all(const scene::Scene& scene, std::uint64_t seed = 0, const std::vector<Scan>& bins_alone = {});
/// Its noise-free twin, as exact rays see the scene. Organized clouds agree pixel by pixel.
MergedScan scan_exactly_from_all(scene::Scene scene, const std::vector<Scan>& bins_alone = {});

/// What exact rays of each of the scene's scanners see of its bin, were nothing else there.
std::vector<Scan> scan_bin_alone(const scene::Scene& scene);

/// "3.13.5": the Embree that was compiled in.
const char* embree_version();

}  // namespace tubebin::scan
