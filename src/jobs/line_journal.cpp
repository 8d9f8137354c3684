#include "tubebin/jobs/line_journal.hpp"

#include "jobs/append_line.hpp"
#include "tubebin/core/atomic_file.hpp"

namespace tubebin::jobs {

LineJournal::LineJournal(OutputFolder folder, ConfinedPath name) : folder_(std::move(folder)), name_(std::move(name)) {
  if (!folder_.has_file(name_)) return;
  const std::string text = read_file(path());
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', complete_bytes_)) {
    lines_.push_back(text.substr(complete_bytes_, end - complete_bytes_));
    complete_bytes_ = end + 1;
  }
}

void LineJournal::append(const std::string& line) {
  complete_bytes_ = append_line(folder_, name_, complete_bytes_, line);
}

}  // namespace tubebin::jobs
