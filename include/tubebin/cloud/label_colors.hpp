/// One colour a label: unique, well apart, the same for the same label wherever it appears.
#pragma once

#include <vector>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::cloud {

/// Colours of labels 0 (bin) to `tube_count`: tube_count + 1 different ones, none of them the null colour.
std::vector<Color> label_colors(std::size_t tube_count);

}  // namespace tubebin::cloud
