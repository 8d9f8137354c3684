/// One scene of a data set in a format that other programs read. Formats: docs/export_formats.md.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::exports {

/// By what numbers a tube is known.
struct TubeNumbers {
  int kind = 1;    ///< among the kinds, from 1
  int object = 1;  ///< tubes of one kind and shape have the same
};

/// A scene's place in the exported data set.
struct SceneEntry {
  std::string name;    ///< "A10/007"
  int number = 1;      ///< among the scenes, from 1
  int first_tube = 1;  ///< number of its tube 1 among all tubes, from 1
  std::vector<TubeNumbers> tubes;
};

/// What is exported. The cloud has one label a point.
struct SceneToExport {
  SceneEntry entry;
  scene::SceneRecord record;
  cloud::Cloud cloud;
};

/// Bytes by path.
using Files = std::map<std::string, std::string>;

struct SceneFiles {
  Files beside;  ///< by path beneath the output folder, there before the scene is
  Files scene;   ///< by path beneath the scene's own folder; a scene that is one file has it under ""
};

class ExportFormat {
 public:
  virtual ~ExportFormat() = default;
  /// Path beneath the output folder of the scene's own folder or file, which appears with all that belongs to it.
  virtual std::string scene_path(const SceneEntry& entry) const = 0;
  virtual SceneFiles export_scene(const SceneToExport& scene) const = 0;
  /// Files about the whole data set (by path beneath the output folder), when these scenes are there. May read what
  /// export_scene left in `output`.
  virtual Files summarize(const std::vector<SceneEntry>&, const std::string& /*output*/) const { return {}; }
};

}  // namespace tubebin::exports
