#include "tubebin/jobs/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <optional>
#include <thread>

#include "tubebin/core/error.hpp"

namespace tubebin::jobs {
namespace {

// The workers of a run that was killed take a moment to die; so long a start waits for them.
constexpr auto kPatience = std::chrono::seconds(2);

bool try_to_lock(int descriptor, FolderLock::Kind kind) {
  const int operation = (kind == FolderLock::Kind::exclusive ? LOCK_EX : LOCK_SH) | LOCK_NB;
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (flock(descriptor, operation) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) return true;  // a file system that keeps no locks
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

/// "process 1234" as the holder wrote it.
std::string holder(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t size = pread(descriptor, text.data(), text.size(), 0);
  return size > 0 ? "process " + std::string(text.data(), static_cast<std::size_t>(size)) : "another process";
}

void write_holder(int descriptor) {
  const std::string text = fmt::format("{}", getpid());
  // Only for the message above: where it can't be written, the lock holds all the same.
  if (ftruncate(descriptor, 0) == 0 && pwrite(descriptor, text.data(), text.size(), 0) < 0) return;
}

/// Locks the file, or says who has it.
std::optional<std::string> lock_or_tell(const FileDescriptor& file, FolderLock::Kind kind) {
  if (!try_to_lock(file.get(), kind)) return holder(file.get());
  if (kind == FolderLock::Kind::exclusive) write_holder(file.get());
  return std::nullopt;
}

constexpr int kLockFile = O_RDWR | O_CREAT;

}  // namespace

FolderLock::FolderLock(const OutputFolder& folder, Kind kind)
    : file_(open_file({folder.folder().duplicate(), ".lock", folder.path() + "/.lock"}, kLockFile)) {
  require_free(folder.path(), kind);
}

FolderLock::FolderLock(const std::string& folder) {
  const FolderEntry entry = entry_of(folder + "/.lock");
  if (faccessat(entry.folder.get(), entry.name.c_str(), F_OK, AT_SYMLINK_NOFOLLOW) != 0)
    return;  // nobody ever locked it
  file_ = open_file(entry, O_RDONLY);
  require_free(folder, Kind::shared);
}

FolderLock::FolderLock(const OutputFolder& folder, const Shard& packed_shard)
    : file_(open_file(folder.make_entry(packed_shard.name() + ".lock"), kLockFile)) {
  if (const auto other = lock_or_tell(file_, Kind::exclusive))
    throw_io_error("{}: {} is packing shard {}, and two can't; wait for its end", folder.path(), *other,
                   packed_shard.name());
}

void FolderLock::require_free(const std::string& folder, Kind kind) const {
  if (const auto other = lock_or_tell(file_, kind))
    throw_config_error("{}: {} is writing to this folder; wait for its end or choose another folder", folder, *other);
}

}  // namespace tubebin::jobs
