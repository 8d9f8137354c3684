/// Contacts between tubes and a bin that is a triangle mesh. Triangles have two sides and no thickness: a tube is pushed to
/// the side that its axis is on.
#pragma once

#include <vector>

#include "physics/collision.hpp"
#include "tubebin/scene/triangle_tree.hpp"

namespace tubebin::physics {

/// Appends the touches of the mesh (first) and a tube (second) with depth >= `depth_min`.
void collide(const scene::TriangleTree& mesh, const CollisionTube& tube, double depth_min, std::vector<Touch>& out);

}  // namespace tubebin::physics
