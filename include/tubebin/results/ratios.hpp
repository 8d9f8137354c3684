/// Downsampling ratios as a command line gives them.
#pragma once

#include <string>
#include <vector>

namespace tubebin::results {

/// "0.1:1.0:0.1" (first, last, step) or "0.1,0.3,1". Throws ConfigError.
std::vector<double> parse_ratios(const std::string& text);

}  // namespace tubebin::results
