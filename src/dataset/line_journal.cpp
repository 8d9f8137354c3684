#include "tubebin/dataset/line_journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "file_descriptor.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin {

LineJournal::LineJournal(std::string path) : path_(std::move(path)) {
  if (!std::filesystem::exists(path_)) return;
  const std::string text = read_file(path_);
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', complete_bytes_)) {
    lines_.push_back(text.substr(complete_bytes_, end - complete_bytes_));
    complete_bytes_ = end + 1;
  }
}

void LineJournal::append(const std::string& line) {
  const FileDescriptor file(open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  const auto fail = [&] { throw_io_error("{}: cannot be written: {}", path_, std::strerror(errno)); };
  if (file.get() < 0) fail();
  const std::string bytes = line + '\n';
  const auto end = static_cast<off_t>(complete_bytes_);
  if (ftruncate(file.get(), end) != 0) fail();  // what a kill left after the last complete line
  errno = ENOSPC;                               // what a short write means
  if (pwrite(file.get(), bytes.data(), bytes.size(), end) != static_cast<ssize_t>(bytes.size())) {
    const int cause = errno;
    if (ftruncate(file.get(), end) == 0) errno = cause;
    fail();
  }
  complete_bytes_ += bytes.size();
}

void LineJournal::rewrite(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  write_file_atomically(path_, text);
  complete_bytes_ = text.size();
}

}  // namespace tubebin
