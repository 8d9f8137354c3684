/// Step 1 of the pipeline: what of a scan may be tubes, before what, and from where it was seen.
#pragma once

#include <vector>

#include "modeling/input/background.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/pipeline.hpp"

namespace tubebin::modeling {

/// A scene after step 1.
struct FilteredScene {
  std::vector<cloud::Point> measured;  ///< that `input` views, without noise; none: it views the points that were told
  ModelingInput input;                 ///< with viewpoint and bin as the cloud shows them
  SceneFound found;                    ///< but for what labels tell
  ViewProjection projection;
  Background background;
  FilteredCloud cloud;
};

/// From where the scanner stood, as far as that is known. Throws IoError where a told bin or the box to crop to holds no point.
FilteredScene filter_scene(const ModelingInput& told, const ModelingOptions& options);

/// Makes background of the points with these indices, which ascend; in `cloud` they are no more.
void set_aside(const std::vector<std::uint32_t>& indices, FilteredScene& scene);

/// The same of the points on the faces of a bin that the cloud shows and nobody told of, between the tubes as well, where
/// these leave too little of a face for a flat region.
void set_aside_faces(FilteredScene& scene);

}  // namespace tubebin::modeling
