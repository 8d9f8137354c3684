/// What the lengths of tubes say for and against chains of pieces.
#pragma once

#include <limits>
#include <vector>

namespace tubebin::modeling {

struct LengthModel {
  double radius = 0.0;                                              ///< of the tubes, metres
  double common = 0.0;                                              ///< of the tubes, metres; 0: none that is known
  double longest_likely = std::numeric_limits<double>::infinity();  ///< of the tubes that likely joins alone make

  /// No tube is longer, metres.
  double longest() const;

  /// nats, against a tube of this length, of which so much is bridged, that may go on unseen for `room` (all metres). A
  /// `fragment` stands alone.
  double cost(double length, double bridged, double room, bool is_fragment) const;

  /// nats, for a tube of the common length: one that all lengths up to it are as likely for has it but once in
  /// length / (sqrt(2 pi) sigma).
  double gain(double length, double bridged) const;

  /// Lengths that tubes agree on, of those in sight from end to end: those of the most tube, summed up over them, first.
  std::vector<double> possible_common(std::vector<double> seen) const;

 private:
  double sigma(double bridged) const;
};

}  // namespace tubebin::modeling
