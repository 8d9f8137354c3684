/// A text file that grows by whole lines and outlives a kill at any moment.
#pragma once

#include <string>
#include <vector>

#include "tubebin/core/folder_entry.hpp"

namespace tubebin::jobs {

class LineJournal {
 public:
  /// A file that is not there has no lines. Throws IoError.
  LineJournal(OutputFolder folder, ConfinedPath name);

  std::string path() const { return folder_.place(name_); }
  /// The complete lines, without their ends, as they were at the start; the last one may have been cut short by a kill,
  /// and is not among them.
  const std::vector<std::string>& lines() const { return lines_; }

  /// Appends a line; after an error (IoError) the file is as it was before.
  void append(const std::string& line);

 private:
  OutputFolder folder_;
  ConfinedPath name_;
  std::size_t complete_bytes_ = 0;  // up to the end of the last complete line
  std::vector<std::string> lines_;
};

}  // namespace tubebin::jobs
