/// Whether the scanner can have stood where it is told, and where it is taken to have stood instead.
#pragma once

#include <string>

#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/modeling_input.hpp"

namespace tubebin::modeling {

struct ViewpointCheck {
  std::string doubt;       ///< why the told one is wrong; empty: it is not
  bool is_certain = true;  ///< the rows and columns show it, or there is one for each source
};

/// Moves the input's viewpoint to where the grid of an organized cloud shows it, if it is told elsewhere, and that of any other
/// cloud to where it can all be seen from, if too much of it is hidden from the told one. A viewpoint for each source is not
/// looked at.
ViewpointCheck check_viewpoint(ModelingInput& input);

/// Whether the surface clearly curves inward more often than outward: that of tubes is seen from outside.
bool is_seen_from_behind(const FilteredCloud& cloud, const ViewProjection& projection);

/// Moves the viewpoint to the other side of the cloud.
void look_from_the_other_side(ModelingInput& input);

}  // namespace tubebin::modeling
