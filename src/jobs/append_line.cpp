#include "jobs/append_line.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/file_descriptor.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::jobs {

std::size_t append_line(const std::string& path, int open_flags, std::size_t complete_bytes, const std::string& line) {
  const FileDescriptor file(open(path.c_str(), O_RDWR | O_CLOEXEC | open_flags, 0666));
  const auto fail = [&] { throw_io_error("{}: cannot be written: {}", path, std::strerror(errno)); };
  if (file.get() < 0) fail();
  const std::string bytes = line + '\n';
  const auto end = static_cast<off_t>(complete_bytes);
  if (ftruncate(file.get(), end) != 0) fail();
  errno = ENOSPC;  // what a short write means
  if (pwrite(file.get(), bytes.data(), bytes.size(), end) != static_cast<ssize_t>(bytes.size())) {
    const int cause = errno;
    if (ftruncate(file.get(), end) == 0) errno = cause;
    fail();
  }
  return complete_bytes + bytes.size();
}

}  // namespace tubebin::jobs
