/// What a result was made from, so that nobody takes it for a result of other files at the same place.
#pragma once

#include <ctime>
#include <map>
#include <string>

#include "tubebin/scene/dataset_files.hpp"

namespace tubebin::scene {

/// XXH3 128-bit hashes in hexadecimal; empty where there is no such file.
struct InputHashes {
  std::string cloud_xxh128;
  std::string scene_json_xxh128;

  friend bool operator==(const InputHashes&, const InputHashes&) = default;
};

/// Throws IoError, which names `result`, where it was made from other files than `scene`, a place, has now. What the scene
/// lacks now is not compared.
void require_same(const InputHashes& made_from, const InputHashes& now, const std::string& result,
                  const std::string& scene);

/// The hashes of a data set's scenes.
class DatasetHashes {
 public:
  /// Reads the data set's manifest, if it has one. Throws IoError. `files` must outlive it.
  explicit DatasetHashes(const DatasetFiles& files);

  /// Of the files as they are now. A cloud is not read where the manifest tells its hash: where scene.json is the recorded
  /// one, and the cloud's file has not changed since the manifest was written. Throws IoError.
  InputHashes of(const ConfinedPath& scene) const;

  /// Throws IoError where the manifest records other hashes of the scene than these, of files just read.
  void require_recorded(const ConfinedPath& scene, const InputHashes& read) const;

 private:
  void read_manifest(const std::string& path);
  bool is_older_than_manifest(const std::string& path) const;

  const DatasetFiles& files_;
  std::map<std::string, InputHashes> recorded_;
  std::timespec manifest_written_{};
};

}  // namespace tubebin::scene
