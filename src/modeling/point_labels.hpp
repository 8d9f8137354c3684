/// Labelling (step 5 of the pipeline): every point takes the tube that it lies on.
#pragma once

#include <span>
#include <vector>

#include "modeling/input/background.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

struct PointLabels {
  std::vector<cloud::Label> labels;  ///< of each point: k for tubes[k - 1], 0 where it belongs to none
  double noise = 0.0;                ///< metres, standard deviation of the points' distances to the tubes' surfaces
};

/// Labels of the points; `tubes` whose points lie anywhere about them, but not on their surface, go.
PointLabels label_points(std::span<const cloud::Point> points, std::vector<TubeModel>& tubes,
                         const Background& background);

/// Labels of other points of the same scan.
std::vector<cloud::Label> label_further_points(std::span<const cloud::Point> points,
                                               const std::vector<TubeModel>& tubes, const Background& background);

/// Labels of points that were set aside with a plane: a tube's where one's surface explains the point as well, where a
/// plane cuts through it. Not where the surface is turned away from the point's one of `viewpoints`, or, without any, from the
/// projection's: of a tube along a wall the scanner sees no more there than the wall. `noise`: metres.
std::vector<cloud::Label> label_set_aside(std::span<const cloud::Point> points, const std::vector<TubeModel>& tubes,
                                          double noise, const ViewProjection& projection,
                                          std::span<const cloud::Point> viewpoints);

}  // namespace tubebin::modeling
