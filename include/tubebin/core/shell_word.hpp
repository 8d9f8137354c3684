/// Commands that a user can copy into a shell.
#pragma once

#include <string>

namespace tubebin {

/// The text as one word of a POSIX shell: quoted where it must be.
std::string shell_word(const std::string& text);

}  // namespace tubebin
