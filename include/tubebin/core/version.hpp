/// The version of this library, as it stands in every file that it writes.
#pragma once

namespace tubebin {

/// "0.1.0"
const char* tool_version();

}  // namespace tubebin
