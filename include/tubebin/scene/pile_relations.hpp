/// What a picking planner wants to know of a pile: who covers whom in the image, and who lies on whom.
#pragma once

#include <vector>

#include "tubebin/scene/scene.hpp"

namespace tubebin::scene {

/// Pixels in which the surface of `front` (0: the bin) lies before that of tube `behind`.
struct Occlusion {
  std::uint32_t front = 0;
  std::uint32_t behind = 0;
  std::size_t pixels = 0;

  friend bool operator==(const Occlusion&, const Occlusion&) = default;
};

/// Tube `upper` is in the way of tube `lower` straight up.
struct Above {
  std::uint32_t upper = 0;
  std::uint32_t lower = 0;

  friend auto operator<=>(const Above&, const Above&) = default;
};

/// Labels in ascending order.
using LabelGroup = std::vector<std::uint32_t>;

struct PileRelations {
  std::vector<std::size_t> amodal_pixels;  ///< of tube k at [k - 1]: that it would show if nothing else were there
  std::vector<Occlusion> occlusions;       ///< sorted by behind, then front
  std::vector<Above> above;                ///< sorted

  /// A tube without any above it can be lifted straight up without moving another.
  bool is_liftable(std::uint32_t label) const;

  friend bool operator==(const PileRelations&, const PileRelations&) = default;
};

/// Two tubes that meet in plan view by less than this much of each surface slide past each other, metres: half of
/// the interpenetration that the published scenes rest with.
constexpr double kGrazing = 0.0005;

/// All ordered pairs of tubes of which some vertical line passes first through the lower and then through the upper
/// one, deeper than kGrazing below the surface of each. Exactly those are in the way when the lower one moves
/// straight up while the others stand still. Bores count as solid. The bin, open above, is in nobody's way.
std::vector<Above> find_above(const std::vector<PlacedTube>& tubes);

/// Whether find_above would find a tube above that of the label.
bool has_above(const std::vector<PlacedTube>& tubes, std::uint32_t label);

/// The knots of a pile: largest groups of two tubes or more of which each is, through a chain of the others, both above
/// and below each other one (the strongly connected components of the graph of `above`). None of a group can be lifted
/// straight up before another of the group was moved otherwise. Sorted by their first labels.
std::vector<LabelGroup> entangled_groups(std::size_t tube_count, const std::vector<Above>& above);

/// A tube's axis as polylines (node indices): one from end to end, or one for each stretch between free ends and
/// branchings; a ring's ends where it began; a node alone is one of a single node.
std::vector<std::vector<int>> centerline_paths(const tube::Tube& tube);

}  // namespace tubebin::scene
