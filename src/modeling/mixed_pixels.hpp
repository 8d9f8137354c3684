/// Points in mid-air behind a tube's edge. A pixel at the edge sees the tube and what lies behind it, and many scanners put
/// its point somewhere between the two (docs/scanner_effects.md#mixed-pixels-mixed_pixels). So lie points of a steep wall, too:
/// only before a known background can they be told.
#pragma once

#include <vector>

#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Gives lone points without a label that of the nearest tube whose edge their ray passes, where they lie behind it.
/// `labels`: of the cloud's points, k for tubes[k - 1].
void label_mixed_pixels(const FilteredCloud& cloud, const ViewProjection& projection,
                        const std::vector<TubeModel>& tubes, std::vector<cloud::Label>& labels);

}  // namespace tubebin::modeling
