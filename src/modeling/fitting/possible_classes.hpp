/// What was found of each radius before others were known, and what of it stays once they are.
#pragma once

#include <span>
#include <vector>

#include "modeling/fitting/piece_evidence.hpp"
#include "modeling/fitting/tube_classes.hpp"

namespace tubebin::modeling {

/// Short and with little evidence, of a curvature that is a little off, or believed for a known bin's sake: it may be a bit of a
/// tube of another radius.
struct UnsurePiece {
  TubePiece piece;
  double off = 0.0;  ///< curvature, in units of 1 / radius
  std::vector<cloud::Point> points;
};

struct PossibleClass {
  TubeClass sure;
  std::vector<UnsurePiece> unsure;
  double evidence = 0.0;         ///< nats, of its long pieces
  bool has_ground = false;       ///< that is rough
  double typical_off = 0.0;      ///< the median of their curvatures' errors, in units of 1 / radius
  OutlineEvidence outline = {};  ///< edge and level, the mean along all of them
};

/// Whether the piece, whose curvature is `off` (in units of 1 / radius), fits hardly better than an unsure piece of an earlier
/// class in its place, as far as curvatures can be trusted: real scans blur them by more than their points scatter.
bool is_known(const TubePiece& piece, double off, std::span<const PossibleClass> earlier);

/// The classes with those unsure pieces most of whose points no tube of another class surely explains. `spacing`: metres between
/// the cloud's points.
std::vector<TubeClass> settled(std::span<const PossibleClass> possible, double spacing);

}  // namespace tubebin::modeling
