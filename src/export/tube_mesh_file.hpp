// A tube's mesh for pose estimation, in its own frame, millimetres.
#pragma once

#include <string>

#include "tubebin/tube/tube.hpp"

namespace tubebin::exports {

struct TubeMeshFile {
  std::string ply;  ///< binary, vertices with normals, triangles
  Eigen::AlignedBox3d bounds_mm;
  double diameter_mm = 0.0;  ///< largest distance of two vertices
};

TubeMeshFile tube_mesh_file(const tube::Tube& tube);

}  // namespace tubebin::exports
