/// Procedural tubes: Algorithm 1 of the paper (Section 3), for every shape and for several kinds at once.
#pragma once

#include <functional>
#include <vector>

#include "tubebin/tube/tube_path.hpp"
#include "tubebin/tube/tube_shape.hpp"

namespace tubebin::tube {

/// One kind of tube. The path is that of a chain, the paper's tube; other shapes have options of their own.
struct TubeOptions : PathOptions {
  ShapeChoice shape;
  double radius = 0.0125;       ///< r, metres
  double wall_thickness = 0.0;  ///< metres; 0: solid
  double mass = 0.055;          ///< kilograms; the real PVC tubes weigh 0.055, the published simulation took 0.5
};

void describe(Fields& fields, TubeOptions& options);
void check(const TubeOptions& options, const KeyPlaces& places, const std::string& prefix);

/// A kind of tube in a mixed bin.
struct TubeKind : TubeOptions {
  std::string name;    ///< in the ground truth; empty: kind_name makes one
  int count = 0;       ///< of this kind in each scene
  double share = 0.0;  ///< weight in the draw of each of the scene's further tubes
};

void describe(Fields& fields, TubeKind& kind);
/// `tube_counts` are the scenes' numbers of tubes; "kinds" and "tubes" are the keys that messages name.
void check(const std::vector<TubeKind>& kinds, const std::vector<int>& tube_counts, const KeyPlaces& places);

/// Draws what differs from tube to tube: changes the options of tube `number` (from 0), which is of kinds[kind], and
/// returns what it drew.
using DrawOptions = std::function<DrawnNumbers(std::size_t number, std::size_t kind, TubeOptions& options)>;

/// Algorithm 1: `count` tubes, each in a frame with its first node at the origin or its middle there.
std::vector<Tube> generate_tubes(int count, const TubeOptions& options, Random& random,
                                 const DrawOptions& draw_options = {});

/// The name of kinds[index]: its own, or that of its shape and its place in the list, as "ring_3".
std::string kind_name(const std::vector<TubeKind>& kinds, std::size_t index);

/// `count` tubes of several kinds in random order, each with its kind's name: of each kind its own count, the others
/// drawn by share.
std::vector<Tube> generate_mixed_tubes(int count, const std::vector<TubeKind>& kinds, Random& random,
                                       const DrawOptions& draw_options = {});

}  // namespace tubebin::tube
