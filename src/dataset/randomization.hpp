// The numbers that a configuration leaves open, drawn: a tube's own (tube.*, kinds[].*) for each tube, all others for each
// scene. Each has a stream of its own, by its key, so that one more of them leaves the others as they were.
#pragma once

#include "tubebin/dataset/dataset_config.hpp"

namespace tubebin::dataset {

/// Throws ConfigError where a number is drawn that is one for all scenes, or where the bounds of several don't go together.
void check_distributions(const DatasetConfig& config, const KeyPlaces& places);

/// What is drawn once for the scene of that seed.
DrawnNumbers draw_scene_numbers(const DatasetConfig& config, std::uint64_t seed);

/// The configuration with these numbers in their places.
DatasetConfig with_numbers(DatasetConfig config, const DrawnNumbers& drawn);

/// Throws ConfigError where the numbers that were drawn don't go together, though their bounds do.
void check_drawn(const DatasetConfig& config);

/// The tubes of the scene of that seed; `config` has the scene's numbers. Throws ConfigError where those that were drawn for
/// a tube don't go together.
std::vector<tube::Tube> make_tubes(const DatasetConfig& config, int count, std::uint64_t seed, Random& random);

}  // namespace tubebin::dataset
