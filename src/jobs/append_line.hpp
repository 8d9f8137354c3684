/// One line more in a text file that outlives a kill at any moment.
#pragma once

#include <string>

namespace tubebin::jobs {

/// Writes a line after the first `complete_bytes` of the file and cuts off what a kill left behind them. `open_flags`: O_CREAT
/// or 0. Returns the file's new complete bytes. After an error (IoError) the file is as it was before.
std::size_t append_line(const std::string& path, int open_flags, std::size_t complete_bytes, const std::string& line);

}  // namespace tubebin::jobs
