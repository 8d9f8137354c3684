// Zip archives of files that are stored as they are.
#pragma once

#include <string>

#include "export/scene_export.hpp"

namespace tubebin::exports {

/// The archive's bytes; equal files give equal bytes. Throws std::length_error beyond 4 GB.
std::string format_zip(const Files& files);

}  // namespace tubebin::exports
