/// Wide surfaces that are no tubes': ground that is not flat, cloth, the sides of large things.
#pragma once

#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {

/// The cloud without the points of wide surfaces less curved than a tube of this radius. The votes p - r n of a tube gather in
/// a line, those of such a surface in a sheet. Slivers of tubes and what lies at their crossings are small, and stay.
FilteredCloud without_sheets(const FilteredCloud& cloud, double radius);

}  // namespace tubebin::modeling
