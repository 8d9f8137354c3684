/// The output folder of one data set: locked, made by one configuration, with its manifest and scenes. Several hosts
/// may each make a shard in one folder.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tubebin/dataset/dataset_config.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/dataset/scene_store.hpp"
#include "tubebin/jobs/folder_lock.hpp"

namespace tubebin::dataset {

/// The configuration of an existing data set, of whatever version. Throws IoError where the folder has none,
/// ConfigError where it can't be read or its values can't be meant.
DatasetConfig read_dataset_config(const std::string& folder);

/// Throws ConfigError where another version made it: what this one checks or adds would not be the same.
void require_own_version(const DatasetConfig& config, const std::string& folder);

/// A data set open for generation. Whatever a killed run left unfinished is gone.
class DatasetFolder {
 public:
  /// Makes the folder, or continues the one that is there: it may gain tubes and cases. Throws ConfigError where
  /// another run holds it or another configuration, seed or version made it (with all differing keys), IoError
  /// where it can't be written.
  DatasetFolder(const std::string& folder, const DatasetConfig& config);

  /// What becomes of a shard's scenes.
  enum class ShardScenes { loose, packed };

  /// The same for one shard, while others may make the other shards: touches nothing but its scenes. Throws
  /// IoError where another run packs the same shard.
  DatasetFolder(const std::string& folder, const DatasetConfig& config, const jobs::Shard& shard, ShardScenes scenes);

  /// Removes what workers were stopped in the middle of; not for a shard.
  ~DatasetFolder();
  DatasetFolder(const DatasetFolder&) = delete;
  DatasetFolder& operator=(const DatasetFolder&) = delete;

  /// All scenes that were ever asked for.
  const DatasetConfig& config() const { return config_; }
  Manifest& manifest() { return manifest_; }
  const Manifest& manifest() const { return manifest_; }
  const SceneStore& store() const { return store_; }

  /// Makes config.yaml again where somebody removed it meanwhile. Throws IoError where the folder is gone.
  void restore_config();

  /// True where the scene is recorded and its files are there.
  bool is_complete(const std::string& scene_name) const;

 private:
  void remove_unfinished() const;

  OutputFolder folder_;
  std::optional<std::vector<SceneId>> shard_scenes_;  // of whoever makes a shard alone
  jobs::FolderLock lock_;
  DatasetConfig config_;
  SceneStore store_;
  std::unique_ptr<jobs::FolderLock> pack_lock_;
  Manifest manifest_;
};

}  // namespace tubebin::dataset
