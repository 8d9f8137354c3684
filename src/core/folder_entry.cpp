#include "tubebin/core/folder_entry.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/sendfile.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <system_error>

#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/text_scan.hpp"

namespace tubebin {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kUnfinishedSuffix = ".partial";
constexpr int kOpenFolder = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;

std::string message(int error) { return std::generic_category().message(error); }

/// The entry's kind, as S_IFLNK; 0 where there is none.
mode_t kind_of(const FolderEntry& entry) {
  struct stat status;
  const bool found =
      entry.folder.get() >= 0 && ::fstatat(entry.folder.get(), entry.name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0;
  return found ? status.st_mode & S_IFMT : 0;
}

void remove_what_is_in(const FolderEntry& entry) {
  const FileDescriptor folder(::openat(entry.folder.get(), entry.name.c_str(), kOpenFolder));
  if (folder.get() < 0 && errno == ENOENT) return;  // another was quicker
  if (folder.get() < 0) fail_at(entry, "cannot be removed", errno);
  for (const std::string& name : names_in(folder)) remove_entry({folder.duplicate(), name, entry.place + "/" + name});
}

/// Of long names a part, so that what follows fits into a file system's 255 bytes.
std::string unfinished_start(const std::string& name) { return fmt::format(".{}.", name.substr(0, 150)); }

/// So that its bytes under other names stay as they are.
void replace_by_copy(const FolderEntry& entry) {
  const FolderEntry copy{entry.folder.duplicate(), unfinished_name(entry.name), entry.place};
  copy_file(open_file(entry, O_RDONLY), copy);
  if (::renameat(copy.folder.get(), copy.name.c_str(), copy.folder.get(), entry.name.c_str()) != 0)
    fail_at(entry, "cannot be written", errno);
}

}  // namespace

void fail_at(const FolderEntry& entry, const char* problem, int error) {
  if ((error == ELOOP || error == ENOTDIR || error == EMLINK) && kind_of(entry) == S_IFLNK)
    throw_io_error("{}: {}: is a link, which may lead out of the output folder; remove it", entry.place, problem);
  throw_io_error("{}: {}: {}", entry.place, problem, message(error));
}

FolderEntry entry_of(const std::string& path) {
  const fs::path file(path);
  const std::string folder = file.parent_path().empty() ? "." : file.parent_path().string();
  FolderEntry entry{FileDescriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)),
                    file.has_filename() ? file.filename().string() : ".", path};
  if (entry.folder.get() < 0) throw_io_error("{}: cannot be written: {}", path, message(errno));
  return entry;
}

FileDescriptor open_file(const FolderEntry& entry, int flags) {
  const bool writes = (flags & O_ACCMODE) != O_RDONLY;
  const char* problem = writes ? "cannot be written" : "cannot be read";
  // A named pipe without a reader would block for ever otherwise.
  FileDescriptor file(
      ::openat(entry.folder.get(), entry.name.c_str(), flags | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666));
  struct stat status;
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0) fail_at(entry, problem, errno);
  if (!S_ISREG(status.st_mode)) throw_io_error("{}: {}: is no regular file", entry.place, problem);
  if (!writes || status.st_nlink < 2) return file;
  replace_by_copy(entry);
  return open_file(entry, flags);
}

void copy_file(const FileDescriptor& from, const FolderEntry& to) {
  const FileDescriptor file = open_file(to, O_WRONLY | O_CREAT | O_EXCL);
  struct stat status;
  if (::fstat(from.get(), &status) != 0) fail_at(to, "cannot be written", errno);
  for (off_t copied = 0; copied < status.st_size;) {
    const ssize_t count =
        ::sendfile(file.get(), from.get(), &copied, static_cast<std::size_t>(status.st_size - copied));
    if (count < 0 && errno != EINTR) fail_at(to, "cannot be written", errno);
    if (count == 0) throw_io_error("{}: cannot be written: what it is copied from became shorter", to.place);
  }
  if (::fsync(file.get()) != 0) fail_at(to, "cannot be written", errno);
}

FileDescriptor open_folder(const FolderEntry& entry, bool make) {
  while (true) {
    FileDescriptor folder(::openat(entry.folder.get(), entry.name.c_str(), kOpenFolder));
    if (folder.get() >= 0) return folder;
    if (errno != ENOENT || !make) fail_at(entry, make ? "cannot be written" : "cannot be read", errno);
    if (::mkdirat(entry.folder.get(), entry.name.c_str(), 0777) == 0) sync_folder(entry.folder, entry.place);
    else if (errno != EEXIST) fail_at(entry, "cannot be made", errno);
  }
}

void remove_entry(const FolderEntry& entry) {
  if (::unlinkat(entry.folder.get(), entry.name.c_str(), 0) == 0 || errno == ENOENT) return;
  if (errno != EISDIR && errno != EPERM) fail_at(entry, "cannot be removed", errno);
  // Whoever still writes into it may make some files more before it meets an error.
  constexpr int kTriesMax = 1000;
  for (int i = 0; i < kTriesMax; ++i) {
    remove_what_is_in(entry);
    if (::unlinkat(entry.folder.get(), entry.name.c_str(), AT_REMOVEDIR) == 0 || errno == ENOENT) return;
    if (errno != ENOTEMPTY && errno != EEXIST) break;
  }
  fail_at(entry, "cannot be removed", errno);
}

std::vector<std::string> names_in(const FileDescriptor& folder) {
  std::vector<std::string> names;
  // A descriptor of its own, since reading moves on in it.
  const int own = ::openat(folder.get(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const std::unique_ptr<DIR, int (*)(DIR*)> listing(own < 0 ? nullptr : ::fdopendir(own), ::closedir);
  if (!listing) return names;  // it was removed meanwhile
  while (const dirent* entry = ::readdir(listing.get()))
    if (const std::string name = entry->d_name; name != "." && name != "..") names.push_back(name);
  return names;
}

void sync_folder(const FileDescriptor& folder, const std::string& place) {
  // Some file systems can't sync folders; there a rename is as safe as they make it.
  if (::fsync(folder.get()) != 0 && errno != EINVAL && errno != ENOTSUP)
    throw_io_error("{}: its folder cannot be synced: {}", place, message(errno));
}

std::string unfinished_name(const std::string& name) {
  static std::atomic<unsigned> counter = 0;
  return fmt::format("{}{}-{}{}", unfinished_start(name), process_name(), counter++, kUnfinishedSuffix);
}

bool is_unfinished_name(std::string_view name) { return name.starts_with('.') && name.ends_with(kUnfinishedSuffix); }

std::string finished_name(std::string_view unfinished) {
  return std::string(unfinished.substr(1, unfinished.find('.', 1) - 1));
}

void remove_unfinished_of_the_dead(const FolderEntry& entry) {
  const std::string own = process_name();
  const std::string start = unfinished_start(entry.name) + own.substr(0, own.rfind('-') + 1);
  for (const std::string& name : names_in(entry.folder)) {
    if (!is_unfinished_name(name) || !name.starts_with(start)) continue;
    const auto process = to_number<pid_t>(name.substr(start.size(), name.find('-', start.size()) - start.size()));
    if (process && *process > 0 && ::kill(*process, 0) != 0 && errno == ESRCH)
      remove_entry({entry.folder.duplicate(), name, entry.place});
  }
}

OutputFolder::OutputFolder(std::string path) : path_(std::move(path)) {
  std::error_code error;
  fs::create_directories(path_, error);
  folder_ = std::make_shared<FileDescriptor>(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder_->get() >= 0) return;
  const int cause = errno;
  throw_io_error("{}: cannot be made: {}", path_,
                 cause == ENOTDIR ? "a file of that name is there"
                 : error          ? error.message()
                                  : message(cause));
}

OutputFolder::OutputFolder(std::string path, FileDescriptor folder)
    : path_(std::move(path)), folder_(std::make_shared<FileDescriptor>(std::move(folder))) {}

FileDescriptor OutputFolder::open(const ConfinedPath& name) const {
  if (name.is_folder_itself()) return folder_->duplicate();
  const FolderEntry entry = find_entry(name);
  return kind_of(entry) == S_IFDIR ? open_folder(entry, false) : FileDescriptor();
}

std::string OutputFolder::place(const ConfinedPath& name) const {
  return name.is_folder_itself() ? path_ : path_ + "/" + name.str();
}

FolderEntry OutputFolder::entry(const ConfinedPath& name, bool make) const {
  if (name.is_folder_itself()) throw_io_error("{}: is the output folder itself, where a name in it is wanted", path_);
  FolderEntry entry{folder_->duplicate(), "", path_};
  const std::string& text = name.str();
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('/', begin), text.size());
    if (!entry.name.empty()) {
      if (!make && kind_of(entry) != S_IFDIR) return {FileDescriptor(), name.name(), place(name)};
      entry.folder = open_folder(entry, make);
    }
    entry.name = text.substr(begin, end - begin);
    entry.place += "/" + entry.name;
    begin = end + 1;
  }
  return entry;
}

OutputFolder OutputFolder::make_inner(const ConfinedPath& name) const {
  return {place(name), open_folder(make_entry(name), true)};
}

FolderEntry OutputFolder::make_entry(const ConfinedPath& name) const { return entry(name, true); }

FolderEntry OutputFolder::find_entry(const ConfinedPath& name) const { return entry(name, false); }

bool OutputFolder::has_file(const ConfinedPath& name) const { return kind_of(find_entry(name)) == S_IFREG; }

bool OutputFolder::has_folder(const ConfinedPath& name) const { return kind_of(find_entry(name)) == S_IFDIR; }

}  // namespace tubebin
