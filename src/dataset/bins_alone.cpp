#include "dataset/bins_alone.hpp"

namespace tubebin::dataset {

const std::vector<scan::Scan>& BinsAlone::of(const Piles& piles) {
  if (!scans_.empty() && piles.drawn == drawn_) return scans_;
  scans_.clear();
  drawn_ = piles.drawn;
  const bool is_shared = drawn_.empty() || piles.piles.size() > 1;
  if (is_shared) scans_ = scan::scan_bin_alone(scene_of(piles.config, piles.piles.front()));
  return scans_;
}

}  // namespace tubebin::dataset
