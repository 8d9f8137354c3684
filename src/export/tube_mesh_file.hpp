// A tube's mesh in its own frame, as files that other programs read.
#pragma once

#include <string>

#include "tubebin/tube/tube.hpp"

namespace tubebin::exports {

struct TubeMeshFile {
  std::string ply;  ///< binary, vertices with normals, triangles
  Eigen::AlignedBox3d bounds_mm;
  double diameter_mm = 0.0;  ///< largest distance of two vertices
};

/// For pose estimation, millimetres.
TubeMeshFile tube_mesh_file(const tube::Tube& tube);

/// For simulators: binary STL, metres.
std::string tube_stl(const tube::Tube& tube);

}  // namespace tubebin::exports
