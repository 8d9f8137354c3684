// Normals of whatever shapes a ray caster knows.
#pragma once

#include "scan/ray_caster.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::scan {

/// The unit normal, towards the camera, world axes, of the surface at depth `hit.depth` along the ray through image
/// position (x, y): from where two rays close by meet it.
Vec3 surface_normal(const RayCaster& caster, const scene::Camera& camera, double x, double y, const Hit& hit);

}  // namespace tubebin::scan
