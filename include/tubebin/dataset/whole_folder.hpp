/// A folder that appears with all of its files, or not at all.
#pragma once

#include <functional>
#include <map>
#include <string>

namespace tubebin {

/// Writes the files (bytes by name) into a hidden sibling of `path`, syncs it, and renames it to `path`, in the place
/// of what was there. `meanwhile` runs while the bytes are on their way to the disk; if it throws, nothing is left.
/// Throws IoError.
void write_whole_folder(const std::string& path, const std::map<std::string, std::string>& files,
                        const std::function<void()>& meanwhile = [] {});

/// True for what a killed write_whole_folder leaves behind.
bool is_unfinished_folder(const std::string& path);

}  // namespace tubebin
