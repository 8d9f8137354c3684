/// What every page of ours begins with.
#pragma once

#include <string>

namespace tubebin::evaluation {

/// Up to <body>, with the report's style and `further_style`.
std::string page_head(const char* title, const std::string& further_style);

}  // namespace tubebin::evaluation
