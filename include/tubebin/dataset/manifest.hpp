/// manifest.jsonl: one line of JSON for each complete scene of a data set, appended when the scene is complete.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tubebin/dataset/worker_pool.hpp"
#include "tubebin/physics/drop_simulator.hpp"

namespace tubebin {

struct FileRecord {
  std::uint64_t bytes = 0;
  std::string xxh128;  ///< XXH3 128-bit hash in hexadecimal, as the program xxh128sum prints it

  friend bool operator==(const FileRecord&, const FileRecord&) = default;
};

/// What the manifest says about a scene.
struct ManifestRecord {
  std::string id;  ///< "A10/007"
  int tubes = 0;
  std::uint64_t seed = 0;                 ///< of the attempt that succeeded
  std::vector<FailedAttempt> rejected;    ///< the attempts before it
  std::map<std::string, double> seconds;  ///< wall-clock time by stage, and "total" with all attempts
  DropFigures physics;
  std::map<std::string, FileRecord> files;  ///< by name in the scene's folder
};

/// One line, without the line's end.
std::string format_manifest_record(const ManifestRecord& record);
/// Throws IoError saying what is missing or wrong.
ManifestRecord parse_manifest_record(const std::string& line);

/// Size and hash of a file's bytes.
FileRecord record_bytes(std::string_view bytes);

class Manifest {
 public:
  /// Reads `folder`/manifest.jsonl, if there is one. Of two records of one scene the later one counts.
  explicit Manifest(const std::string& folder);

  const std::map<std::string, ManifestRecord>& records() const { return records_; }
  const ManifestRecord* find(const std::string& id) const;
  /// Lines that are no records, as "DIR/manifest.jsonl:12: problem". A last line that a kill cut short is not among
  /// them.
  const std::vector<std::string>& damaged_lines() const { return damaged_lines_; }

  /// Appends a line; after an error (IoError) the file is as it was before.
  void append(const ManifestRecord& record);

  /// Writes the file anew without these scenes and without damaged lines.
  void rewrite_without(const std::set<std::string>& ids);

 private:
  std::string path_;
  std::size_t complete_bytes_ = 0;  // up to the end of the last complete line
  std::map<std::string, ManifestRecord> records_;
  std::vector<std::string> damaged_lines_;
};

}  // namespace tubebin
