/// Texts that JSON and terminals can take.
#pragma once

#include <string_view>

namespace tubebin {

/// Whether the bytes are UTF-8 (RFC 3629: no surrogates, no longer forms than needed).
bool is_utf8(std::string_view text);

}  // namespace tubebin
