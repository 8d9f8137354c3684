/// One name in one open folder: what is done to it is done there, wherever links lead and whatever becomes of the folder's
/// own name meanwhile.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tubebin/core/confined_path.hpp"
#include "tubebin/core/file_descriptor.hpp"

namespace tubebin {

struct FolderEntry {
  FileDescriptor folder;
  std::string name;
  std::string place;  ///< the path, for messages
};

/// Of a path that the user names: links on the way to its folder are followed. Throws IoError.
FolderEntry entry_of(const std::string& path);

/// The file, opened as `flags` of open() say, made with them where they say so. A link is not followed, and what is no
/// regular file is refused. To be written, a file that has other names (hard links) is first replaced by a copy. Throws
/// IoError.
FileDescriptor open_file(const FolderEntry& entry, int flags);

/// The bytes of `from` as a new file that is on the disk. Throws IoError.
void copy_file(const FileDescriptor& from, const FolderEntry& to);

/// The folder of that name, no link; made where it is missing and `make` says so. Throws IoError.
FileDescriptor open_folder(const FolderEntry& entry, bool make);

/// Removes the file, the link, or the folder with all that is in it; nothing where there is none. Links in it are removed,
/// not followed. Throws IoError.
void remove_entry(const FolderEntry& entry);

/// All names in it but "." and "..".
std::vector<std::string> names_in(const FileDescriptor& folder);

/// Waits until names made in it or taken from it are so on the disk, too. Throws IoError.
void sync_folder(const FileDescriptor& folder, const std::string& place);

/// A temporary sibling of the name: hidden, and no other process's.
std::string unfinished_name(const std::string& name);
/// Whether this is such a name, of whatever process.
bool is_unfinished_name(std::string_view name);
/// "007" of ".007.host-1234-0.partial".
std::string finished_name(std::string_view unfinished);

/// Removes what killed processes of this host left of this name.
void remove_unfinished_of_the_dead(const FolderEntry& entry);

/// "DIR/A10: is a link, ..." or "DIR/A10: cannot be written: No space left on device". `error`: of errno.
[[noreturn]] void fail_at(const FolderEntry& entry, const char* problem, int error);

/// A folder that a program writes into, held open. Nothing is written, replaced or removed but beneath it: names are
/// ConfinedPaths, and links beneath it are not followed. Once the folder is removed, every use fails, instead of making
/// another one of its name.
class OutputFolder {
 public:
  /// The user's word: links on the way to it are followed, and what is missing is made. Throws IoError.
  explicit OutputFolder(std::string path);

  /// One that is open already; `path` is for messages.
  OutputFolder(std::string path, FileDescriptor folder);

  const std::string& path() const { return path_; }
  const FileDescriptor& folder() const { return *folder_; }
  /// "DIR/A10/007", for messages.
  std::string place(const ConfinedPath& name) const;

  /// A folder beneath, made where it is missing. Throws IoError.
  OutputFolder make_inner(const ConfinedPath& name) const;
  /// The name in its folder, whose own folders are made where they are missing. Throws IoError.
  FolderEntry make_entry(const ConfinedPath& name) const;
  /// The same where all folders are there; else its `folder` is not open.
  FolderEntry find_entry(const ConfinedPath& name) const;

  /// The folder beneath, or itself; not open where it isn't there, or is a link.
  FileDescriptor open(const ConfinedPath& name) const;
  bool has_file(const ConfinedPath& name) const;
  bool has_folder(const ConfinedPath& name) const;

 private:
  FolderEntry entry(const ConfinedPath& name, bool make) const;

  std::string path_;
  std::shared_ptr<const FileDescriptor> folder_;
};

}  // namespace tubebin
