#include "scan/occlusion_counter.hpp"

#include <algorithm>

namespace tubebin::scan {

OcclusionCounter::OcclusionCounter(const scene::Scene& scene, const scene::Camera& camera)
    : bin_(scene, camera), bodies_(scene.tubes.size() + 1), pixels_(bodies_ * bodies_, 0) {}

void OcclusionCounter::count(std::span<const Layer> tubes, int column, int row) {
  const double deepest = std::ranges::max(tubes, {}, &Layer::depth).depth;
  const Layer walls = {0, bin_.first_before(deepest, column, row)};
  for (const Layer& behind : tubes) {
    if (walls.is_before(behind)) ++pixels_[behind.label * bodies_];
    for (const Layer& front : tubes)
      if (front.label != behind.label && front.is_before(behind)) ++pixels_[behind.label * bodies_ + front.label];
  }
}

std::vector<scene::Occlusion> OcclusionCounter::occlusions() const {
  std::vector<scene::Occlusion> occlusions;
  for (std::size_t i = 0; i < pixels_.size(); ++i)
    if (pixels_[i] > 0)
      occlusions.push_back(
          {static_cast<cloud::Label>(i % bodies_), static_cast<cloud::Label>(i / bodies_), pixels_[i]});
  return occlusions;
}

}  // namespace tubebin::scan
