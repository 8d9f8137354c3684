/// Piles at rest, before anyone looks at them.
#pragma once

#include "tubebin/dataset/generate_scene.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin::dataset {

struct Pile {
  std::uint64_t seed = 0;  ///< of the scene that shows it
  physics::DropResult rest;
  std::optional<scene::Surroundings> surroundings;
  std::optional<scene::Lift> lift;  ///< that left it
  std::map<std::string, double> seconds;
};

/// A drop, and what lifting one tube after the other leaves of it.
struct Piles {
  std::string failure;  ///< as GeneratedScene's; then there is no pile
  std::string failure_detail;
  physics::DropFigures physics;  ///< of what failed
  std::vector<Pile> piles;       ///< after 0, 1, ..., lifts lifts
  DatasetConfig config = {};     ///< with the numbers that were drawn for them
  DrawnNumbers drawn = {};       ///< these
};

Piles make_piles(const DatasetConfig& config, const SceneId& id, int attempt, int lifts);

/// Around the tubes of a pile that nothing was lifted from; `seed` is the scene's. The stream is its own, so that it changes
/// nothing about the pile.
scene::PlacedSurroundings draw_surroundings(const DatasetConfig& config, std::uint64_t seed,
                                            const std::vector<scene::PlacedTube>& tubes);

/// The pile in its bin, before the scanners.
scene::Scene scene_of(const DatasetConfig& config, const Pile& pile);

/// Scans piles[step], and tells how it lies. `bins_alone`: none, or their bin as each scanner sees it alone, which makes it
/// faster.
GeneratedScene show_pile(const Piles& piles, const SceneId& id, const std::vector<scan::Scan>& bins_alone);

}  // namespace tubebin::dataset
