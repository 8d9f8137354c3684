/// Ends of tubes that go on almost straight toward the scanner or away from it.
#pragma once

#include <vector>

#include "modeling/joining/occlusion.hpp"
#include "tubebin/cloud/cloud.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Lengthens paths along points without a label that lie on the side of a tube seen at less than some 45 degrees. A thin tube's are
/// too far apart there for normals, and no cylinder was fitted to them. Their places alone show the side, if the scan shows a
/// surface wherever it has to be in sight. `labels`: of the cloud's points, 0 or 1 + the tube's place. True if any path changed.
bool reach_steep_ends(std::vector<TubeModel>& tubes, const FilteredCloud& cloud,
                      const std::vector<cloud::Label>& labels, const ViewProjection& projection,
                      const OcclusionTest& scan);

}  // namespace tubebin::modeling
