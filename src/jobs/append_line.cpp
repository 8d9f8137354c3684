#include "jobs/append_line.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "tubebin/core/error.hpp"

namespace tubebin::jobs {

std::size_t append_line(const OutputFolder& output, const ConfinedPath& name, std::size_t complete_bytes,
                        const std::string& line) {
  const FolderEntry entry = output.make_entry(name);
  const FileDescriptor file = open_file(entry, O_RDWR | (complete_bytes == 0 ? O_CREAT : 0));
  const auto fail = [&] { fail_at(entry, "cannot be written", errno); };
  const std::string bytes = line + '\n';
  const auto end = static_cast<off_t>(complete_bytes);
  struct stat status;
  if (fstat(file.get(), &status) != 0) fail();
  // Cutting to a length beyond the file's own would fill it up with zeros.
  if (status.st_size < end)
    throw_io_error("{}: cannot be written: lost its lines meanwhile: it has {} bytes of {}", entry.place,
                   status.st_size, complete_bytes);
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
