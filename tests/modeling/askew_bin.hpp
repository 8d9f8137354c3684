/// A bin that stands askew in the world, for tests.
#pragma once

#include "tubebin/modeling/pipeline.hpp"

namespace tubebin::modeling {

inline const BinFound kAskewBin{
    .world_from_bin = make_pose(Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())), {0.3, -0.2, 1.1}),
    .length = 0.3,
    .width = 0.2,
    .height = 0.1};

}  // namespace tubebin::modeling
