/// Centrelines of real and modelled tubes: how far apart they are, and what the scanner could see of them.
#pragma once

#include <optional>
#include <vector>

#include "tubebin/scene/scene.hpp"

namespace tubebin::evaluation {

/// A straight segment of a centreline, metres, world frame.
struct CenterlineSegment {
  Vec3 start;
  Vec3 end;
  bool bridged = false;  ///< modelled over a stretch that the scanner could not see
};

/// The axes of a tube's cylinders; chains, trees and loops alike.
using Centerline = std::vector<CenterlineSegment>;

/// A real or modelled tube's axis.
struct TubeLine {
  Centerline centerline;
  double radius = 0.0;             ///< metres; 0: not known
  std::optional<double> log_odds;  ///< nats, of a modelled tube: for its least sure part, a bridge or that it is a tube
};

/// Distance between neighbouring samples of a centreline, metres.
constexpr double kCenterlineStep = 0.005;

/// Distances between two centrelines, metres.
struct CenterlineError {
  double model_mean = 0.0;  ///< from the model's segments that are not bridged to the real centreline
  double model_p95 = 0.0;
  double truth_mean = 0.0;  ///< from the visible part of the real centreline to the model's
  double truth_p95 = 0.0;
  int model_samples = 0;
  int truth_samples = 0;  ///< 0: no part is visible
};

/// Points along a centreline, with what is known of their visibility.
struct CenterlineSamples {
  std::vector<Vec3> points;
  std::vector<char> visible;

  /// Share of the samples that are visible.
  double visible_fraction() const;
};

/// The axes of the tube's cylinders in the world frame.
Centerline centerline(const scene::PlacedTube& tube);
/// Those of every tube of the scene.
std::vector<TubeLine> tube_lines(const scene::Scene& scene);

/// Samples of every tube of the scene. One is visible if no other tube crosses the line from the scanner to
/// it.
std::vector<CenterlineSamples> sample_centerlines(const scene::Scene& scene);

/// `truth_samples` are those of `truth`. The model has at least one segment that is not bridged.
CenterlineError centerline_error(const Centerline& truth, const CenterlineSamples& truth_samples,
                                 const Centerline& model);

}  // namespace tubebin::evaluation
