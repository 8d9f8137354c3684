#include "tubebin/core/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "core/file_descriptor.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin {
namespace {

[[noreturn]] void fail(const std::string& path, const char* problem, int error) {
  throw_io_error("{}: {}: {}", path, problem, std::generic_category().message(error));
}

/// A file under a temporary name, gone at the end of the scope unless it was renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& final_path) : final_path_(final_path), file_(open_new()) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!temporary_path_.empty()) ::unlink(temporary_path_.c_str());
  }

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(file_.get(), bytes.data(), bytes.size());
      if (written >= 0) bytes.remove_prefix(static_cast<std::size_t>(written));
      else if (errno != EINTR) fail(final_path_, "cannot be written", errno);
    }
    if (::fsync(file_.get()) != 0) fail(final_path_, "cannot be written", errno);
    if (file_.close() != 0) fail(final_path_, "cannot be written", errno);
  }

  /// A hard link is what network file systems keep to be made once. Returns false where the name is taken.
  bool link_to_final() {
    if (::link(temporary_path_.c_str(), final_path_.c_str()) == 0) return true;  // the temporary name goes by itself
    if (errno == EEXIST) return false;
    if (errno != EPERM && errno != ENOTSUP && errno != ENOSYS && errno != EMLINK)
      fail(final_path_, "cannot be written", errno);
    if (::access(final_path_.c_str(), F_OK) == 0) return false;
    rename_to_final();  // a file system without hard links
    return true;
  }

  void rename_to_final() {
    if (::rename(temporary_path_.c_str(), final_path_.c_str()) != 0) fail(final_path_, "cannot be written", errno);
    temporary_path_.clear();
  }

 private:
  /// Another thread, or an earlier process of the same id that was killed, may hold a name: take the next.
  int open_new() {
    static std::atomic<unsigned> counter = 0;
    while (true) {
      const std::string candidate = fmt::format("{}.{}-{}.tmp", final_path_, ::getpid(), counter++);
      const int number = ::open(candidate.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (number >= 0) {
        temporary_path_ = candidate;
        return number;
      }
      if (errno != EEXIST && errno != EINTR) fail(final_path_, "cannot be written", errno);
    }
  }

  std::string final_path_;
  std::string temporary_path_;
  FileDescriptor file_;
};

/// The rename itself is only on the disk once the folder is. Some file systems cannot sync folders; there the
/// file is as safe as they make it.
void sync_folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const FileDescriptor descriptor(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.get() < 0 || ::fsync(descriptor.get()) == 0 || errno == EINVAL || errno == ENOTSUP) return;
  fail(path, "its folder cannot be synced", errno);
}

}  // namespace

void write_file_atomically(const std::string& path, std::string_view bytes) {
  struct stat status;
  // A rename would put a regular file in the place of a folder or a device.
  if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode))
    throw_io_error("{}: cannot be written: exists and is no regular file", path);
  TemporaryFile file(path);
  file.write(bytes);
  file.rename_to_final();
  sync_folder_of(path);
}

bool create_file_atomically(const std::string& path, std::string_view bytes) {
  TemporaryFile file(path);
  file.write(bytes);
  if (!file.link_to_final()) return false;
  sync_folder_of(path);
  return true;
}

std::string process_name() {
  std::array<char, 65> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0 || host[0] == '\0') host = {"host"};
  return fmt::format("{}-{}", host.data(), ::getpid());
}

std::string read_file(const std::string& path) {
  // A named pipe without a writer would block in open() for ever otherwise.
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status;
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0) fail(path, "cannot be read", errno);
  if (S_ISDIR(status.st_mode)) throw_io_error("{}: cannot be read: is a folder", path);
  if (!S_ISREG(status.st_mode)) throw_io_error("{}: cannot be read: is no regular file", path);

  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t count = ::read(file.get(), bytes.data() + filled, bytes.size() - filled);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(path, "cannot be read", errno);
    if (count == 0) break;  // the file shrank meanwhile
    filled += static_cast<std::size_t>(count);
  }
  bytes.resize(filled);
  return bytes;
}

}  // namespace tubebin
