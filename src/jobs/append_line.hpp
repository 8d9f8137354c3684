/// One line more in a text file that outlives a kill at any moment.
#pragma once

#include <string>

#include "tubebin/core/folder_entry.hpp"

namespace tubebin::jobs {

/// Writes a line after the first `complete_bytes` of the file, which is made where these are 0, and cuts off what a kill left
/// behind them. Returns the file's new complete bytes. After an error (IoError) the file is as it was before; it is an error
/// where the file is gone or shorter than these.
std::size_t append_line(const OutputFolder& output, const ConfinedPath& name, std::size_t complete_bytes,
                        const std::string& line);

}  // namespace tubebin::jobs
