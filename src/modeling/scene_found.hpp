/// What the scene was found to be.
#pragma once

#include "modeling/input/background.hpp"
#include "tubebin/modeling/pipeline.hpp"

namespace tubebin::modeling {

/// Of metres, as messages have it.
std::string place_text(const Vec3& p);

/// Up is across the largest region with nothing behind it: floor or table; `told_up` (zero: none) counts instead.
void describe_scene(const Background& background, const ViewProjection& projection, const Vec3& told_up,
                    SceneFound& found);

/// Says in `found.doubts` what of the result looks wrong. One thick tube alone does, unless `radii_are_told`.
void add_doubts(ModelingResult& result, bool radii_are_told);

}  // namespace tubebin::modeling
