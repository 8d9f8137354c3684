#include "tubebin/core/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <deque>
#include <iterator>
#include <set>
#include <system_error>

#include "tubebin/core/error.hpp"

namespace tubebin {
namespace {

[[noreturn]] void fail(const std::string& path, const char* problem, int error) {
  throw_io_error("{}: {}: {}", path, problem, std::generic_category().message(error));
}

/// A file under a temporary name, gone at the end of the scope unless it was renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const FolderEntry& target)
      : target_(target), name_(unfinished_name(target.name)), file_(open_new()) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!name_.empty()) ::unlinkat(folder(), name_.c_str(), 0);
  }

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(file_.get(), bytes.data(), bytes.size());
      if (written >= 0) bytes.remove_prefix(static_cast<std::size_t>(written));
      else if (errno != EINTR) fail();
    }
    ::sync_file_range(file_.get(), 0, 0, SYNC_FILE_RANGE_WRITE);  // only begins; what fails shows in sync()
  }

  void sync() {
    if (::fsync(file_.get()) != 0) fail();
    if (file_.close() != 0) fail();
  }

  /// A hard link is what network file systems keep to be made once. Returns false where the name is taken.
  bool link_to_final() {
    if (::linkat(folder(), name_.c_str(), folder(), target_.name.c_str(), 0) == 0)
      return true;  // the other goes by itself
    if (errno == EEXIST) return false;
    if (errno != EPERM && errno != ENOTSUP && errno != ENOSYS && errno != EMLINK) fail();
    if (::faccessat(folder(), target_.name.c_str(), F_OK, AT_SYMLINK_NOFOLLOW) == 0) return false;
    rename_to_final();  // a file system without hard links
    return true;
  }

  void rename_to_final() {
    if (::renameat(folder(), name_.c_str(), folder(), target_.name.c_str()) != 0) fail();
    name_.clear();
  }

 private:
  int folder() const { return target_.folder.get(); }
  [[noreturn]] void fail() const { fail_at(target_, "cannot be written", errno); }

  /// An earlier process of the same id that was killed may hold a name: take the next.
  int open_new() {
    while (true) {
      const int number = ::openat(folder(), name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
      if (number >= 0) return number;
      if (errno != EEXIST && errno != EINTR) {
        name_.clear();
        fail();
      }
      name_ = unfinished_name(target_.name);
    }
  }

  const FolderEntry& target_;
  std::string name_;
  FileDescriptor file_;
};

/// A rename would put a regular file in the place of a device, or fail at a folder.
void refuse_if_no_file(const FolderEntry& entry) {
  struct stat status;
  if (::fstatat(entry.folder.get(), entry.name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 &&
      !S_ISREG(status.st_mode) && !S_ISLNK(status.st_mode))
    throw_io_error("{}: cannot be written: exists and is no regular file", entry.place);
}

}  // namespace

void write_atomically(const FolderEntry& entry, std::string_view bytes) {
  refuse_if_no_file(entry);
  TemporaryFile file(entry);
  file.write(bytes);
  file.sync();
  file.rename_to_final();
  sync_folder(entry.folder, entry.place);
}

void write_all_atomically(const OutputFolder& output, const std::map<std::string, std::string>& files) {
  constexpr std::ptrdiff_t kOpenFilesMax = 256;  // with a descriptor of its folder each; many systems allow 1024
  std::set<ConfinedPath> folders;
  for (auto begin = files.begin(); begin != files.end();) {
    const auto end = std::next(begin, std::min(kOpenFilesMax, std::distance(begin, files.end())));
    std::deque<FolderEntry> entries;
    std::deque<TemporaryFile> written;
    for (; begin != end; ++begin) {
      const ConfinedPath name = begin->first;
      folders.insert(name.parent());
      refuse_if_no_file(entries.emplace_back(output.make_entry(name)));
      written.emplace_back(entries.back()).write(begin->second);
    }
    for (TemporaryFile& file : written) file.sync();
    for (TemporaryFile& file : written) file.rename_to_final();
  }
  for (const ConfinedPath& folder : folders) sync_folder(output.open(folder), output.place(folder));
}

bool create_atomically(const FolderEntry& entry, std::string_view bytes) {
  TemporaryFile file(entry);
  file.write(bytes);
  file.sync();
  if (!file.link_to_final()) return false;
  sync_folder(entry.folder, entry.place);
  return true;
}

void write_file_atomically(const std::string& path, std::string_view bytes) {
  struct stat status;
  // As /dev/stdout, a link to a pipe: the user's own link, which is not to become a file.
  if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode))
    throw_io_error("{}: cannot be written: exists and is no regular file", path);
  const FolderEntry entry = entry_of(path);
  remove_unfinished_of_the_dead(entry);
  write_atomically(entry, bytes);
}

std::string process_name() {
  std::array<char, 65> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0 || host[0] == '\0') host = {"host"};
  return fmt::format("{}-{}", host.data(), ::getpid());
}

std::string read_file(const std::string& path, std::uint64_t bytes_max) {
  // A named pipe without a writer would block in open() for ever otherwise.
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status;
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0) fail(path, "cannot be read", errno);
  if (S_ISDIR(status.st_mode)) throw_io_error("{}: cannot be read: is a folder", path);
  if (!S_ISREG(status.st_mode)) throw_io_error("{}: cannot be read: is no regular file", path);
  if (static_cast<std::uint64_t>(status.st_size) > bytes_max)
    throw_io_error("{}: cannot be read: has {} bytes; valid: up to {}", path, status.st_size, bytes_max);
  return read_bytes(file, 0, static_cast<std::uint64_t>(status.st_size), path);
}

std::string read_bytes(const FileDescriptor& file, std::uint64_t offset, std::uint64_t count, const std::string& name) {
  std::string bytes;
  try {
    bytes.resize(count);
  } catch (const std::exception&) {  // bad_alloc, length_error
    throw_io_error("{}: cannot be read: {} bytes are more than there is memory for", name, count);
  }
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t got =
        ::pread(file.get(), bytes.data() + filled, bytes.size() - filled, static_cast<off_t>(offset + filled));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(name, "cannot be read", errno);
    if (got == 0) break;  // the file shrank meanwhile
    filled += static_cast<std::size_t>(got);
  }
  bytes.resize(filled);
  return bytes;
}

}  // namespace tubebin
