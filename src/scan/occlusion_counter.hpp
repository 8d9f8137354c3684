// Who covers whom, counted pixel by pixel.
#pragma once

#include <span>
#include <vector>

#include "scan/bin_front.hpp"
#include "tubebin/scene/pile_relations.hpp"

namespace tubebin::scan {

class OcclusionCounter {
 public:
  OcclusionCounter(const scene::Scene& scene, const scene::Camera& camera);

  const BinFront& bin() const { return bin_; }
  /// `tubes`: all that the pixel's ray meets, at least one.
  void count(std::span<const Layer> tubes, int column, int row);
  /// Sorted by behind, then front.
  std::vector<scene::Occlusion> occlusions() const;

 private:
  BinFront bin_;
  std::size_t bodies_;
  std::vector<std::size_t> pixels_;  ///< at behind * bodies_ + front
};

}  // namespace tubebin::scan
