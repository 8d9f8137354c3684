// Where the published data set keeps a scene: A10/plys/7.ply.
#pragma once

#include <string>

#include "export/scene_export.hpp"

namespace tubebin::exports {

/// "A10/007", "plys", ".ply" -> "A10/plys/7.ply".
inline std::string published_path(const SceneEntry& entry, const std::string& folder, const std::string& extension) {
  const std::size_t slash = entry.name.rfind('/');
  std::string file = entry.name.substr(slash == std::string::npos ? 0 : slash + 1);
  const std::size_t digits = file.find_first_not_of('0');
  if (digits != std::string::npos) file.erase(0, digits);
  return (slash == std::string::npos ? "" : entry.name.substr(0, slash + 1)) + folder + "/" + file + extension;
}

}  // namespace tubebin::exports
