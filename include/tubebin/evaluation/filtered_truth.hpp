/// The ground truth of the points that a program worked on.
#pragma once

#include "tubebin/evaluation/cloud_pair.hpp"

namespace tubebin::evaluation {

/// A part of a scene's cloud with the scene's labels.
struct FilteredTruth {
  cloud::Cloud cloud;     ///< the part's points in its order, without colours
  double coverage = 1.0;  ///< share of the scene's points of tubes that are in it
};

/// Least share of a scene's points of tubes, and of every tube with many points, that a part must have to stand for the
/// scene: half of the lowest downsampling ratio of the paper. Who chooses fewer points chooses what is scored.
constexpr double kCoverageMin = 0.05;

/// `scene` has labels; `filtered` may say of its points what it likes, their ground truth is the scene's. Points are
/// matched by position, as pair_clouds does. Throws IoError where `filtered` has points that the scene does not have, or
/// less of it than kCoverageMin.
FilteredTruth filtered_truth(const NamedCloud& scene, const NamedCloud& filtered);

}  // namespace tubebin::evaluation
