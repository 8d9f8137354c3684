/// manifest.jsonl: one line of JSON for each complete scene of a data set, appended when the scene is complete.
///
/// Runs that make a shard each in one folder, on several hosts, write no file together: each appends to a file of its
/// own in manifest.parts/, and whoever reads the manifest reads them all.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tubebin/core/file_record.hpp"
#include "tubebin/core/folder_entry.hpp"
#include "tubebin/dataset/scene_id.hpp"
#include "tubebin/jobs/worker_pool.hpp"
#include "tubebin/physics/drop_simulator.hpp"

namespace tubebin::dataset {

/// What the manifest says about a scene.
struct ManifestRecord {
  ConfinedPath id;  ///< "A10/007"
  int tubes = 0;
  std::uint64_t seed = 0;                     ///< of the attempt that succeeded
  std::vector<jobs::FailedAttempt> rejected;  ///< the attempts before it
  std::map<std::string, double> seconds;      ///< wall-clock time by stage; "total" has all attempts, but no "preview"
  physics::DropFigures physics;
  std::map<ConfinedPath, FileRecord> files;  ///< by name in the scene's folder
  std::optional<ConfinedPath> pack = {};     ///< "00002-of-00004.tar" that holds the files instead of a folder
  std::uint64_t pack_end = 0;                ///< bytes of the pack up to the end of the scene's last file
};

/// One line, without the line's end.
std::string format_manifest_record(const ManifestRecord& record);
/// Throws IoError saying what is missing or wrong, also where a name leads out of its folder.
ManifestRecord parse_manifest_record(const std::string& line);

/// In a data set's folder: where the runs of shards keep files of their own until they are merged.
constexpr const char* kShardsFolder = "manifest.parts";

class Manifest {
 public:
  /// Reads `folder`/manifest.jsonl and the shards' files, if they are there. Of two records of one scene the later one counts, but
  /// for one of a packed scene, which only another such replaces: packing comes last.
  /// This one is only read.
  explicit Manifest(const std::string& folder);
  explicit Manifest(const OutputFolder& folder);

  /// Of a run that makes these scenes, the shard `shard`: it reads the records of these alone and appends to a file of
  /// its own.
  Manifest(const OutputFolder& folder, const jobs::Shard& shard, const std::vector<SceneId>& scenes);

  const std::map<std::string, ManifestRecord>& records() const { return records_; }
  const ManifestRecord* find(const std::string& id) const;
  /// Lines that are no records, as "DIR/manifest.jsonl:12: problem". A last line that a kill cut short, or that is just
  /// being written, is not among them.
  const std::vector<std::string>& damaged_lines() const { return damaged_lines_; }

  /// Appends a line; after an error (IoError) the file is as it was before.
  void append(const ManifestRecord& record);

  /// Writes manifest.jsonl anew, with all records but those of these scenes, and removes the shards' files. For whoever has
  /// the folder to himself.
  void rewrite_without(const std::set<std::string>& ids);

  /// The same with the records of these scenes alone, in their order.
  void rewrite(const std::vector<SceneId>& scenes);

 private:
  static constexpr const char* kFile = "manifest.jsonl";

  /// Returns the bytes up to the end of the last complete line.
  std::size_t read(const std::string& path, const std::set<std::string>* wanted);
  void replace_all(const std::string& text);

  void read_all(const std::string& folder, const std::set<std::string>* wanted);

  std::optional<OutputFolder> output_;  // nothing where it is only read
  ConfinedPath file_ = kFile;           // that append() writes to; of a shard, the folder itself until it is made
  std::string shard_name_;              // of a shard's run
  std::size_t complete_bytes_ = 0;      // of `file_`, up to the end of the last complete line
  std::map<std::string, ManifestRecord> records_;
  std::vector<std::string> damaged_lines_;
};

}  // namespace tubebin::dataset
