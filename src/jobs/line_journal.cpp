#include "tubebin/jobs/line_journal.hpp"

#include <fcntl.h>

#include <filesystem>

#include "jobs/append_line.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::jobs {

LineJournal::LineJournal(std::string path) : path_(std::move(path)) {
  if (!std::filesystem::exists(path_)) return;
  const std::string text = read_file(path_);
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', complete_bytes_)) {
    lines_.push_back(text.substr(complete_bytes_, end - complete_bytes_));
    complete_bytes_ = end + 1;
  }
}

void LineJournal::append(const std::string& line) {
  complete_bytes_ = append_line(path_, O_CREAT, complete_bytes_, line);
}

}  // namespace tubebin::jobs
