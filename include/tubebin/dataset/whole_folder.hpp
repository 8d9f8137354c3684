/// A folder that appears with all of its files, or not at all.
#pragma once

#include <functional>
#include <map>
#include <string>

namespace tubebin {

/// Begins to write the files (bytes by path beneath it) into a hidden sibling of `path`. The returned function waits until they
/// are on the disk and renames the sibling to `path`, in the place of what was there; without its call nothing is
/// left. Both throw IoError.
std::function<void()> begin_whole_folder(const std::string& path, const std::map<std::string, std::string>& files);

/// True for what a kill leaves behind while a folder is being written.
bool is_unfinished_folder(const std::string& path);

/// Removes what kills left in `folder` of folders that were being written into it. Throws IoError.
void remove_unfinished_folders(const std::string& folder);

}  // namespace tubebin
