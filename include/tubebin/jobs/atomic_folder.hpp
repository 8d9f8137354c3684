/// A folder that appears with all of its files, or not at all.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>

namespace tubebin::jobs {

/// Begins to write the files (bytes by path beneath it) into a hidden sibling of `path`. The returned function waits until they
/// are on the disk and renames the sibling to `path`, in the place of what was there; without its call nothing is
/// left. Both throw IoError.
std::function<void()> begin_whole_folder(const std::string& path, const std::map<std::string, std::string>& files);

/// Begins the same with hard links to files that are there (`sources`: their paths by path beneath `path`), and copies of
/// them where the disk is another one or makes no links.
std::function<void()> begin_linked_folder(const std::string& path, const std::map<std::string, std::string>& sources);

/// One file likewise: `path` appears whole. What was there is replaced. Throws IoError.
void link_file(const std::string& source, const std::string& path);

/// True for what a kill leaves behind while a folder is being written.
bool is_unfinished_folder(const std::string& path);

/// Removes what kills left in `folder` of folders that were being written into it; where `of` names some (without a dot
/// in their names), of these alone. Throws IoError.
void remove_unfinished_folders(const std::string& folder, const std::set<std::string>& of = {});

}  // namespace tubebin::jobs
