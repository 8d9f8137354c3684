/// What the scanner would see of each tube alone, and which bodies stand before it.
#pragma once

#include <vector>

#include "tubebin/scene/pile_relations.hpp"

namespace tubebin::scan {

/// A pixel of the scanner's full image and the depth (metres along the optical axis) of a surface in it.
struct SeenPixel {
  int column = 0;
  int row = 0;
  double depth = 0.0;
};

/// For each tube the pixels that would show it if nothing else were there (its amodal mask), row by row. Depths are
/// those of scan().
std::vector<std::vector<SeenPixel>> view_tubes_alone(const scene::Scene& scene);

/// Who covers whom, by the tubes' views alone: sorted by behind, then front. A pair's pixels do not depend on third
/// bodies. At equal depths the lower label is in front, as in scan().
std::vector<scene::Occlusion> find_occlusions(const scene::Scene& scene,
                                              const std::vector<std::vector<SeenPixel>>& views);

struct PileView {
  std::vector<std::size_t> amodal_pixels;    ///< of tube k at [k - 1]: size of its view alone
  std::vector<scene::Occlusion> occlusions;  ///< as find_occlusions finds them

  friend bool operator==(const PileView&, const PileView&) = default;
};

/// The counts of both functions above, without their pixels and several times as fast; of several scanners all
/// together.
PileView view_pile(const scene::Scene& scene);

}  // namespace tubebin::scan
