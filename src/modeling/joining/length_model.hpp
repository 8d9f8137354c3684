/// What the lengths of tubes say for and against chains of pieces.
#pragma once

#include <limits>
#include <vector>

namespace tubebin::modeling {

struct LengthModel {
  double radius = 0.0;                                              ///< of the tubes, metres
  std::vector<double> common = {};                                  ///< that each tube has one of, metres; none known
  double longest_likely = std::numeric_limits<double>::infinity();  ///< of the tubes that likely joins alone make

  /// No tube is longer, metres.
  double longest() const;

  /// nats, against a tube of this length beside the common length that suits it best, of which so much is bridged, that may go on unseen for `room` (all metres).
  /// `may_be_chance`: it is of one piece, which may be no tube.
  double cost(double length, double bridged, double room, bool may_be_chance) const;

  /// nats, for a tube that has a common length, or may have it unseen, against one that all lengths up to
  /// `longest_likely` are as likely for.
  double gain(double length, double bridged, double room) const;

  /// nats, against common lengths that only the scan tells: each could be any, and is the best of those that are tried. That all
  /// tubes have one is likely before.
  double cost_of_common_lengths() const;

  /// Lengths that tubes agree on, of those in sight from end to end, no two alike: those of the most tube, summed up over them,
  /// first.
  std::vector<double> possible_common(std::vector<double> seen) const;

  /// Lengths that two tubes or more agree on, of those in sight from end to end, where there are several; else none.
  std::vector<double> recurring(std::vector<double> seen) const;

 private:
  double cost_beside(double common, double length, double bridged, double room, bool may_be_chance) const;
  double gain_beside(double common, double length, double bridged, double room) const;
  double sigma(double bridged) const;
};

}  // namespace tubebin::modeling
