/// The labelled points of a run of model_tubes, for the report's pictures.
#pragma once

#include <optional>

#include "tubebin/evaluation/scene_picture.hpp"

namespace tubebin::results {

/// From the run's clouds where they were kept, else the same points, labelled by the tubes in model.json, or, where that
/// does not give the counts in result.json, modelled again with the run's own options and seed. Nothing where none of these
/// is possible, or where modelling again gives other counts, as another version of the program may. Throws IoError where a
/// file of the run or of its data set is damaged.
std::optional<evaluation::LabelledPoints> labelled_points(const evaluation::RunScore& run);

}  // namespace tubebin::results
