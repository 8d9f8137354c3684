#include "tubebin/jobs/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
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

/// A descriptor of the lock file, made if it isn't there.
int open_lock_file(const std::string& path) {
  const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) throw_io_error("{}: cannot be written: {}", path, std::strerror(errno));
  return descriptor;
}

/// Locks the file, or closes it and says who has it.
std::optional<std::string> lock_or_close(int descriptor, FolderLock::Kind kind) {
  if (try_to_lock(descriptor, kind)) {
    if (kind == FolderLock::Kind::exclusive) write_holder(descriptor);
    return std::nullopt;
  }
  const std::string other = holder(descriptor);
  close(descriptor);
  return other;
}

}  // namespace

FolderLock::FolderLock(const std::string& folder, Kind kind) {
  const std::string path = folder + "/.lock";
  descriptor_ = kind == Kind::shared ? open(path.c_str(), O_RDONLY | O_CLOEXEC) : open_lock_file(path);
  if (descriptor_ < 0) return;  // nobody ever locked it
  if (const auto other = lock_or_close(descriptor_, kind))
    throw_config_error("{}: {} is writing to this folder; wait for its end or choose another folder", folder, *other);
}

FolderLock::FolderLock(const std::string& folder, const Shard& packed_part)
    : descriptor_(open_lock_file(fmt::format("{}/{}.lock", folder, packed_part.name()))) {
  if (const auto other = lock_or_close(descriptor_, Kind::exclusive))
    throw_io_error("{}: {} is packing part {}, and two can't; wait for its end", folder, *other, packed_part.name());
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace tubebin::jobs
