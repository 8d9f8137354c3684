/// The scene folders of a data set. A scene appears whole or not at all: it is written into a folder beside its
/// own, synced, and renamed.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tubebin/dataset/dataset_config.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/dataset/scene_id.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::dataset {

/// Everything that a scene's folder holds.
struct SceneContent {
  scene::SceneRecord record;
  cloud::Cloud cloud;
  std::optional<cloud::Cloud> clean_cloud;    ///< without the scanner's effects
  std::map<std::string, std::string> images;  ///< PNG files by name
};

class SceneStore {
 public:
  SceneStore(OutputFolder folder, OutputOptions options) : folder_(std::move(folder)), options_(options) {}

  /// "DIR"
  const OutputFolder& folder() const { return folder_; }
  /// "DIR/A10/007"
  std::string path(const ConfinedPath& scene_name) const { return folder_.place(scene_name); }
  /// "cloud.pcd" or "cloud.ply"
  std::string cloud_name() const;
  /// "cloud_clean.pcd" or "cloud_clean.ply"
  std::string clean_cloud_name() const;

  /// Begins to write the scene, in the place of any that is there. It is complete when the returned function has
  /// returned its files, after waiting for the disk. Both throw IoError; nothing unfinished is ever under the scene's
  /// name.
  std::function<std::map<ConfinedPath, FileRecord>()> begin_write(const ConfinedPath& scene_name,
                                                                  SceneContent content) const;

  /// True where the scene's folder has the files of the record, each with its size (hashes are for verify), or its pack
  /// is long enough to.
  bool has(const ManifestRecord& record) const;

  /// Removes the scene's folder, if it is there. Throws IoError.
  void remove(const ConfinedPath& scene_name) const;

  /// Removes the folders around these scenes in which nothing is.
  void remove_empty_sets(const std::vector<SceneId>& scenes) const;

  /// Removes what killed runs left unfinished: of anything in these scenes' folders and of what stands beside them, or
  /// `only` of these scenes.
  enum class Unfinished { all, only };
  void remove_unfinished(const std::vector<SceneId>& scenes, Unfinished which) const;

 private:
  OutputFolder folder_;
  OutputOptions options_;
};

}  // namespace tubebin::dataset
