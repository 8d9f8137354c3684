#include "tubebin/core/version.hpp"

namespace tubebin {

const char* tool_version() { return TUBEBIN_VERSION; }

}  // namespace tubebin
