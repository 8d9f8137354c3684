// The rigid motions that leave a tube looking the same.
#pragma once

#include <vector>

#include "tubebin/tube/tube.hpp"

namespace tubebin::exports {

/// As BOP has them: any turn about one of the axes, and each of the single motions; tube frame, metres.
struct Symmetries {
  struct Axis {
    Vec3 direction = Vec3::UnitZ();  ///< unit
    Vec3 origin = Vec3::Zero();
  };
  std::vector<Axis> continuous;
  std::vector<Pose> discrete;  ///< without the identity
};

/// Of balls (three axes, since BOP knows no turns about all), straight tubes, and rings, which count as round: their
/// cylinders are sides of a regular polygon. Other tubes have none.
Symmetries find_symmetries(const tube::Tube& tube);

}  // namespace tubebin::exports
