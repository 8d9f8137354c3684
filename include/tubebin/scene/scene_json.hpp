/// scene.json: the ground truth beside a cloud. Its format is docs/scene.schema.json.
#pragma once

#include <string>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin {

/// Everything that scene.json holds.
struct SceneRecord {
  std::string id;                         ///< "A10/007"
  std::uint64_t seed = 0;                 ///< of the attempt that succeeded
  Scene scene;
  PixelWindow window;                     ///< of the organized cloud in the full image
  std::vector<Color> colors;              ///< of label 0 (bin) and every tube
  std::vector<std::size_t> tube_pixels;   ///< visible pixels of tube k at [k - 1]
  std::vector<Contact> contacts;
};

/// JSON text; equal records give equal bytes, numbers read back exactly.
std::string format_scene_json(const SceneRecord& record);

/// Throws IoError naming the file and the place (JSON pointer) of what is missing or wrong.
SceneRecord read_scene_json(const std::string& path);

}  // namespace tubebin
