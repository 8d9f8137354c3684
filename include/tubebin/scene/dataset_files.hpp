/// The files of a data set's scenes, wherever they lie: loose, DIR/A10/007/cloud.pcd, or packed, as the member
/// A10/007.cloud.pcd of a tar in DIR/packs/ (the layout that WebDataset reads: a sample's files stand together, and
/// share what precedes the first dot).
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tubebin/core/confined_path.hpp"
#include "tubebin/core/tar.hpp"

namespace tubebin::scene {

/// "A10/007.cloud.pcd": the member of a pack that is this file of the scene.
std::string packed_name(const ConfinedPath& scene, const ConfinedPath& file);

/// "DIR/packs"
std::string packs_folder(const std::string& dataset);

class DatasetFiles {
 public:
  /// `dataset` is a data set's folder or a single pack. Packs are listed here, loose files looked for when they are asked
  /// for, and preferred. Throws IoError where a pack can't be read, or has a member whose name leads out of the data set.
  explicit DatasetFiles(const std::string& dataset);

  const std::string& dataset() const { return dataset_; }
  bool has(const ConfinedPath& scene, const ConfinedPath& file) const;
  /// Throws IoError.
  std::string read(const ConfinedPath& scene, const ConfinedPath& file) const;
  /// Where the file lies or would lie, for messages.
  std::string place(const ConfinedPath& scene, const ConfinedPath& file) const;

  /// The file of the file system that it lies in: itself, or a pack.
  std::string holding_file(const ConfinedPath& scene, const ConfinedPath& file) const;

  /// "cloud.pcd" or "cloud.ply", whichever the scene has; "" where it has none.
  std::string cloud_of(const ConfinedPath& scene) const;
  /// Names of all scenes that have a cloud, sorted; "." where it lies in the folder itself. Hidden folders are left out.
  /// Throws IoError.
  std::vector<std::string> scenes() const;

 private:
  struct Packed {
    std::size_t pack;
    TarMember member;  ///< its name is the file's within the scene
  };
  void add_pack(const std::string& path);
  const Packed* find_packed(const ConfinedPath& scene, const ConfinedPath& file) const;
  std::string loose_path(const ConfinedPath& scene, const ConfinedPath& file) const;
  bool is_loose(const ConfinedPath& scene, const ConfinedPath& file) const;

  std::string dataset_;
  bool is_folder_;
  std::vector<std::string> packs_;
  std::map<std::string, std::vector<Packed>> packed_;  // by scene
};

}  // namespace tubebin::scene
