/// A scene as Python holds it.
#pragma once

#include <optional>

#include "bindings.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::python {

struct Scene {
  scene::SceneRecord record;
  std::optional<cloud::Cloud> seen = std::nullopt;  ///< what its scanners saw, where that is known already
};

}  // namespace tubebin::python
