/// A scene's cloud as images of 16 bits a pixel, as depth cameras give them and networks take them: depth.png and
/// labels.png, pixel by pixel the twins of the organized cloud (docs/file_formats.md).
#pragma once

#include <map>
#include <string>

#include "tubebin/scene/dataset_files.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::scene {

/// Depths of a scanner's points as whole numbers of 16 bits.
class DepthScale {
 public:
  explicit DepthScale(const Scanner& scanner);

  /// The finest power of ten, from 0.1 mm on, by which 16 bits hold the scanner's range.
  double mm_per_unit() const { return mm_per_unit_; }
  /// Along the optical axis; what is farther than 16 bits hold gets their highest value.
  std::uint16_t depth(const cloud::Point& p_in_world) const;

 private:
  double mm_per_unit_ = 0.1;
  Pose scanner_from_world_;
};

/// Row by row from the top.
struct DepthImage {
  int width = 0;
  int height = 0;
  double mm_per_unit = 0.1;
  std::vector<std::uint16_t> depths;  ///< units along the optical axis; 0 where nothing was measured
  std::vector<std::uint16_t> labels;  ///< as the cloud's
};

/// The pixels of the record's window. `cloud` is in the world frame and metres. Throws IoError where it is not organized
/// as that window, as clouds of several scanners or of tubes alone are not.
DepthImage depth_image(const cloud::Cloud& cloud, const SceneRecord& record);

/// The files' bytes by name.
std::map<std::string, std::string> format_depth_image(const DepthImage& image);

/// A scene's depth image; of one that was written without, the same from its cloud. `record` is its scene.json.
/// Throws IoError.
DepthImage read_depth_image(const DatasetFiles& files, const ConfinedPath& scene, const SceneRecord& record);

}  // namespace tubebin::scene
