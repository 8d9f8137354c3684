// Which pixels a scene can appear in.
#pragma once

#include "scan/scene_solids.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::scan {

enum class SeenBodies { tubes, bin_and_tubes, all };

/// The pixels whose centres lie within the bounds of the solids' projection: no pixel outside sees one of
/// them at depth_min or beyond. The bounds are exact for solids that lie wholly beyond that depth and within
/// the image. Zero sized where the image shows none of them.
scene::PixelWindow view_window(const SceneSolids& solids, SeenBodies bodies, const scene::Camera& camera,
                               double depth_min);

}  // namespace tubebin::scan
