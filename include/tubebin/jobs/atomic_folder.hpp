/// A folder that appears with all of its files, or not at all.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>

#include "tubebin/core/file_record.hpp"
#include "tubebin/core/folder_entry.hpp"

namespace tubebin::jobs {

/// Hands a file's bytes on.
using FileWriter = std::function<void(const ByteSink&)>;

/// Begins to write the files (by path beneath it) into a hidden sibling of `name`. The returned function waits until they
/// are on the disk and renames the sibling to `name`, in the place of what was there; without its call nothing is
/// left. Both throw IoError.
std::function<void()> begin_whole_folder(const OutputFolder& output, const ConfinedPath& name,
                                         const std::map<std::string, FileWriter>& files);
/// `files`: their bytes.
std::function<void()> begin_whole_folder(const OutputFolder& output, const ConfinedPath& name,
                                         const std::map<std::string, std::string>& files);

/// Begins the same with hard links to files that are there (`sources`: their paths by path beneath `name`), and copies of
/// them where the disk is another one or makes no links.
std::function<void()> begin_linked_folder(const OutputFolder& output, const ConfinedPath& name,
                                          const std::map<ConfinedPath, std::string>& sources);

/// One file likewise: `name` appears whole. What was there is replaced. Throws IoError.
void link_file(const std::string& source, const OutputFolder& output, const ConfinedPath& name);

/// Removes what kills left in `folder` of folders and files that were being written into it; where `of` names some (without
/// a dot in their names), of these alone. Throws IoError.
void remove_unfinished(const OutputFolder& output, const ConfinedPath& folder, const std::set<std::string>& of = {});

}  // namespace tubebin::jobs
