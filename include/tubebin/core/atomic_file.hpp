/// Whole files in and out. A file that is written is complete and on the disk under a temporary name beside
/// it before it takes its own name, so that no reader and no crash ever meets half of one.
#pragma once

#include <string>
#include <string_view>

namespace tubebin {

/// Writes the bytes as the file `path`, replacing what was there. On failure (a full disk, a missing folder,
/// no permission) nothing is left behind, an old file of that name stays as it was, and IoError names path
/// and cause.
void write_file_atomically(const std::string& path, std::string_view bytes);

/// The same where no file of that name is yet. Returns false, and leaves what is there, where one is: of several
/// processes that make it at once, on whatever hosts, one does.
bool create_file_atomically(const std::string& path, std::string_view bytes);

/// "host-1234": this process among all that share a file system, for names that no other uses.
std::string process_name();

/// The bytes of a regular file. Throws IoError naming path and cause.
std::string read_file(const std::string& path);

}  // namespace tubebin
