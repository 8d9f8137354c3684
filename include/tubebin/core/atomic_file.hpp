/// Whole files in and out. A file that is written is complete and on the disk under a temporary name beside
/// it before it takes its own name, so that no reader and no crash ever meets half of one.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>

#include "tubebin/core/folder_entry.hpp"

namespace tubebin {

/// Writes the bytes as the file `path`, replacing what was there. On failure (a full disk, a missing folder,
/// no permission) nothing is left behind, an old file of that name stays as it was, and IoError names path
/// and cause.
void write_file_atomically(const std::string& path, std::string_view bytes);

/// The same where no file of that name is yet. Returns false, and leaves what is there, where one is: of several
/// processes that make it at once, on whatever hosts, one does.
bool create_file_atomically(const std::string& path, std::string_view bytes);

/// Both for a name beneath an output folder; a link of that name is replaced, not followed.
void write_atomically(const FolderEntry& entry, std::string_view bytes);
bool create_atomically(const FolderEntry& entry, std::string_view bytes);
/// Several files (bytes by path beneath it), each appearing whole, in less time than one after the other.
void write_all_atomically(const OutputFolder& output, const std::map<std::string, std::string>& files);

/// "host-1234": this process among all that share a file system, for names that no other uses.
std::string process_name();

/// The bytes of a regular file. Throws IoError naming path and cause, also where it has more than `bytes_max`.
std::string read_file(const std::string& path, std::uint64_t bytes_max = std::numeric_limits<std::uint64_t>::max());

/// So many bytes of an open file, or fewer where it ends before; `name` is the file's, for messages. Throws IoError.
std::string read_bytes(const FileDescriptor& file, std::uint64_t offset, std::uint64_t count, const std::string& name);

}  // namespace tubebin
