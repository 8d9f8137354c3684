#include "tubebin/jobs/atomic_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "tubebin/core/error.hpp"

namespace tubebin::jobs {
namespace {

constexpr const char* kWriting = "cannot be written";

/// At once, with a descriptor of its folder each: many systems let a program have 1024 open.
constexpr std::size_t kOpenFilesMax = 256;

/// The entry's unfinished sibling: hidden, so that the rename stays within one folder, and no other process's, should two
/// make the same scene.
FolderEntry unfinished_sibling(const FolderEntry& entry) {
  return {entry.folder.duplicate(), unfinished_name(entry.name), entry.place};
}

/// Removes the entry at once for everybody else: it is renamed before it is emptied. So who still writes into it gives no
/// final name to a folder some of whose files are gone.
void remove_at_once(const FolderEntry& entry) {
  const FolderEntry removed = unfinished_sibling(entry);
  const int folder = entry.folder.get();
  if (::renameat(folder, entry.name.c_str(), folder, removed.name.c_str()) != 0) {
    if (errno == ENOENT) return;  // another was quicker
    fail_at(entry, "cannot be removed", errno);
  }
  remove_entry(removed);
}

/// A new folder that is gone at the end of the scope unless it was renamed.
class UnfinishedFolder {
 public:
  UnfinishedFolder(const OutputFolder& output, const ConfinedPath& name)
      : content_(output.place(name), make_folder(output, name)) {}
  ~UnfinishedFolder() try { remove_entry(unfinished_); } catch (const IoError&) {  // who clears next tries again
  }
  UnfinishedFolder(const UnfinishedFolder&) = delete;
  UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;

  /// The file's entry; the folders between are made.
  FolderEntry file(const ConfinedPath& name) {
    for (ConfinedPath folder = name.parent(); !folder.is_folder_itself(); folder = folder.parent())
      inner_.insert(folder);
    return content_.make_entry(name);
  }

  void rename_to_final() const {
    for (const ConfinedPath& folder : inner_) {
      const FolderEntry entry = content_.find_entry(folder);
      sync_folder(open_folder(entry, false), entry.place);
    }
    sync_folder(content_.folder(), final_.place);
    while (!take_name())
      ;
    sync_folder(final_.folder, final_.place);
  }

 private:
  FileDescriptor make_folder(const OutputFolder& output, const ConfinedPath& name) {
    while (true) {
      final_ = output.make_entry(name);
      unfinished_ = unfinished_sibling(final_);
      remove_entry(unfinished_);  // of an earlier process of the same id
      if (::mkdirat(unfinished_.folder.get(), unfinished_.name.c_str(), 0777) == 0) break;
      // Another run, which packed all that was in the folder around it, may have removed that meanwhile.
      if (errno != ENOENT || name.parent().is_folder_itself()) fail_at(final_, kWriting, errno);
    }
    return open_folder(unfinished_, false);
  }

  /// Returns false where it is to be tried again, since the name was taken or freed meanwhile.
  bool take_name() const {
    const int folder = final_.folder.get();
    const char *from = unfinished_.name.c_str(), *to = final_.name.c_str();
    if (::renameat(folder, from, folder, to) == 0) return true;
    if (errno != ENOTEMPTY && errno != EEXIST && errno != ENOTDIR) fail_at(final_, kWriting, errno);
    if (::renameat2(folder, from, folder, to, RENAME_EXCHANGE) == 0) {
      remove_at_once(unfinished_);
      return true;
    }
    // Some file systems (NFS) can't exchange names; there the scene is gone for a moment.
    if (errno != ENOENT) remove_at_once(final_);
    return false;
  }

  FolderEntry final_;
  FolderEntry unfinished_;
  OutputFolder content_;
  std::set<ConfinedPath> inner_;
};

/// A new file whose bytes are on their way to the disk, and there after sync().
class NewFile {
 public:
  NewFile(FolderEntry entry, const FileWriter& writer)
      : entry_(std::move(entry)), file_(open_file(entry_, O_WRONLY | O_CREAT | O_EXCL)) {
    writer([this](std::string_view bytes) { write(bytes); });
    sync_file_range(file_.get(), 0, 0, SYNC_FILE_RANGE_WRITE);  // only begins; what fails shows in sync()
  }
  void sync() const {
    if (fsync(file_.get()) != 0) fail_at(entry_, kWriting, errno);
  }

 private:
  void write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = ::write(file_.get(), bytes.data(), bytes.size());
      if (written < 0 && errno != EINTR) fail_at(entry_, kWriting, errno);
      if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  FolderEntry entry_;
  FileDescriptor file_;
};

/// Some file systems make no hard links, and none makes them to another disk.
bool asks_for_copy(int error) {
  return error == EXDEV || error == EPERM || error == ENOTSUP || error == ENOSYS || error == EMLINK;
}

/// A hard link to the file, or a copy that is on the disk. A source that is a link itself, as version control of large
/// files makes them, stands for its file.
void link_or_copy(const std::string& source, const FolderEntry& entry) {
  const FileDescriptor from(::open(source.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  struct stat status;
  if (from.get() < 0 || ::fstat(from.get(), &status) != 0)
    throw_io_error("{}: cannot be read: {}", source, std::strerror(errno));
  if (!S_ISREG(status.st_mode)) throw_io_error("{}: cannot be read: is no regular file", source);
  if (::linkat(AT_FDCWD, source.c_str(), entry.folder.get(), entry.name.c_str(), AT_SYMLINK_FOLLOW) == 0) return;
  if (!asks_for_copy(errno)) fail_at(entry, kWriting, errno);
  copy_file(from, entry);
}

/// The files of one folder, written but not yet on the disk until it is committed.
class FolderTransaction {
 public:
  FolderTransaction(const OutputFolder& output, const ConfinedPath& name,
                    const std::map<std::string, FileWriter>& files)
      : folder_(output, name) {
    for (const auto& [file, writer] : files) {
      if (files_.size() == kOpenFilesMax) sync_files();
      files_.emplace_back(folder_.file(file), writer);
    }
  }

  void commit() {
    sync_files();
    folder_.rename_to_final();
  }

 private:
  void sync_files() {
    for (const NewFile& file : files_) file.sync();
    files_.clear();
  }

  UnfinishedFolder folder_;
  std::vector<NewFile> files_;
};

}  // namespace

std::function<void()> begin_whole_folder(const OutputFolder& output, const ConfinedPath& name,
                                         const std::map<std::string, FileWriter>& files) {
  return [folder = std::make_shared<FolderTransaction>(output, name, files)] { folder->commit(); };
}

std::function<void()> begin_whole_folder(const OutputFolder& output, const ConfinedPath& name,
                                         const std::map<std::string, std::string>& files) {
  std::map<std::string, FileWriter> writers;
  for (const auto& [file, bytes] : files) writers[file] = [&all = bytes](const ByteSink& sink) { sink(all); };
  return begin_whole_folder(output, name, writers);
}

std::function<void()> begin_linked_folder(const OutputFolder& output, const ConfinedPath& name,
                                          const std::map<ConfinedPath, std::string>& sources) {
  const auto folder = std::make_shared<UnfinishedFolder>(output, name);
  for (const auto& [file, source] : sources) link_or_copy(source, folder->file(file));
  return [folder] { folder->rename_to_final(); };
}

void link_file(const std::string& source, const OutputFolder& output, const ConfinedPath& name) {
  const FolderEntry entry = output.make_entry(name);
  const FolderEntry unfinished = unfinished_sibling(entry);
  remove_entry(unfinished);
  link_or_copy(source, unfinished);
  if (::renameat(entry.folder.get(), unfinished.name.c_str(), entry.folder.get(), entry.name.c_str()) != 0)
    fail_at(entry, kWriting, errno);
  // Renaming a link over another one of the same file does nothing and leaves it.
  remove_entry(unfinished);
  sync_folder(entry.folder, entry.place);
}

void remove_unfinished(const OutputFolder& output, const ConfinedPath& folder, const std::set<std::string>& of) {
  const FileDescriptor opened = output.open(folder);
  if (opened.get() < 0) return;
  for (const std::string& name : names_in(opened))
    if (is_unfinished_name(name) && (of.empty() || of.contains(finished_name(name))))
      remove_at_once({opened.duplicate(), name, output.place(folder) + "/" + name});
}

}  // namespace tubebin::jobs
