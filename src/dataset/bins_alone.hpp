/// The bin alone as each scanner sees it: scans of all piles in it take their points from there where they show no tube.
#pragma once

#include "dataset/pile.hpp"

namespace tubebin::dataset {

/// Scanned once for all piles of a data set that share bin and scanners.
class BinsAlone {
 public:
  /// Of each scanner; none where no other scene shares them, since numbers were drawn for this one.
  const std::vector<scan::Scan>& of(const Piles& piles);

 private:
  DrawnNumbers drawn_;
  std::vector<scan::Scan> scans_;
};

}  // namespace tubebin::dataset
