/// A text file that grows by whole lines and outlives a kill at any moment.
#pragma once

#include <string>
#include <vector>

namespace tubebin::jobs {

class LineJournal {
 public:
  /// A file that is not there has no lines. Throws IoError.
  explicit LineJournal(std::string path);

  const std::string& path() const { return path_; }
  /// The complete lines, without their ends, as they were at the start; the last one may have been cut short by a kill,
  /// and is not among them.
  const std::vector<std::string>& lines() const { return lines_; }

  /// Appends a line; after an error (IoError) the file is as it was before.
  void append(const std::string& line);

 private:
  std::string path_;
  std::size_t complete_bytes_ = 0;  // up to the end of the last complete line
  std::vector<std::string> lines_;
};

}  // namespace tubebin::jobs
