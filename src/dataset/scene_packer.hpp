#pragma once

#include <string>
#include <vector>

#include "tubebin/core/file_descriptor.hpp"
#include "tubebin/dataset/dataset_folder.hpp"

namespace tubebin::dataset {

/// Moves complete scenes from their folders into one tar, in the order of the list whatever the order in which they are
/// made, so that the tar's bytes are always the same (but for scenes that were given up and made later, which follow).
/// Scenes that are ahead of their turn wait in their folders; a run that was interrupted goes on where the last one
/// recorded stops.
class ScenePacker {
 public:
  /// Packs into DIR/packs/NAME.tar. Scenes that are complete already wait for their turn.
  ScenePacker(DatasetFolder& folder, const std::vector<SceneId>& scenes, const std::string& name);

  /// The scene at this position of the list is complete in its folder, and recorded.
  void add(std::size_t position);
  /// It won't be; those behind it need not wait.
  void give_up(std::size_t position);
  /// Packs what waited, since no more will come. `is_last`: ends the tar.
  void finish(bool is_last);

 private:
  enum class State { awaited, loose, done };
  void pack_those_in_turn();
  void append(const SceneId& id);
  void flush();
  void write(std::string_view bytes);

  DatasetFolder& folder_;
  const std::vector<SceneId>& scenes_;
  ConfinedPath name_;
  std::string path_;
  std::vector<State> states_;
  std::size_t next_ = 0;
  std::uint64_t end_ = 0;  ///< bytes of the tar
  FileDescriptor file_;
  std::vector<ManifestRecord> unrecorded_;  ///< written, and not known to be on the disk
};

}  // namespace tubebin::dataset
