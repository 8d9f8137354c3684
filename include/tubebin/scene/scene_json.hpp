/// scene.json: the ground truth beside a cloud. Its format is docs/scene.schema.json.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/cloud_space.hpp"
#include "tubebin/scene/lift.hpp"
#include "tubebin/scene/pile_relations.hpp"

namespace tubebin::scene {

/// Everything that scene.json holds.
struct SceneRecord {
  std::string id;          ///< "A10/007"
  std::uint64_t seed = 0;  ///< of the attempt that succeeded
  Scene scene;
  PixelWindow window;                    ///< of the organized cloud in the full image, or of source 0's pixels
  std::vector<cloud::Color> colors;      ///< of label 0 (bin) and every tube
  std::vector<std::size_t> tube_pixels;  ///< visible pixels of tube k at [k - 1], all sources together
  std::vector<Contact> contacts;
  std::vector<PixelWindow> further_windows = {};  ///< of the scene's further scanners
  std::optional<PileRelations> relations;         ///< nothing in files of versions that did not write them
  CloudSpace space = {};                          ///< of the cloud's file
  std::optional<double> depth_mm_per_unit = {};   ///< of depth.png; nothing where none is beside the cloud
  DrawnNumbers drawn = {};                        ///< of the configuration, for the scene; tubes have their own
  std::optional<Lift> lift = {};                  ///< where the pile is what was left after a tube was lifted out
};

/// JSON text; equal records give equal bytes. Throws std::invalid_argument where the record contradicts
/// itself (sizes of lists) or holds a number that is not finite.
std::string format_scene_json(const SceneRecord& record);

/// The record that was written, every number and pose bit by bit. Keys that this version does not know are
/// left alone. Throws IoError naming the file and the place (JSON pointer) of what is missing or wrong, also
/// where convenience values (lengths, nodes in world, quaternions) disagree with what they derive from.
SceneRecord read_scene_json(const std::string& path);

/// Throws IoError where the record, read from `place`, is of another scene than the cloud beside it: where its id is not
/// `name`, the scene's path in its data set (or in a folder of several, or "."), and the cloud does not show as many points
/// of each tube as the record says.
void require_same_scene(const SceneRecord& record, const cloud::Cloud& cloud, const std::string& name,
                        const std::string& place);

/// The scene's cloud from the bytes of its file, in the world frame and metres. Throws as cloud::parse_cloud.
cloud::Cloud parse_scene_cloud(std::string_view bytes, const std::string& name, const SceneRecord& record);

/// As read_scene_json, from a text; `name` stands for the file in messages.
SceneRecord parse_scene_json(std::string_view text, const std::string& name);

}  // namespace tubebin::scene
