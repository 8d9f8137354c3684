/// Commands that a user can copy into a shell.
#pragma once

#include <string>

namespace tubebin {

/// The path as one word of a POSIX shell that no program takes for an option: quoted and begun with ./ where it must be.
std::string shell_path(const std::string& path);

}  // namespace tubebin
