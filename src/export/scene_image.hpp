// A cloud as the scanner's full image: depths, labels, masks, a shaded picture.
#pragma once

#include <string>
#include <vector>

#include "export/scene_export.hpp"
#include "tubebin/scan/visibility.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::exports {

/// Row by row from the top.
template <typename Value>
struct Raster {
  int width = 0;
  int height = 0;
  std::vector<Value> values;

  Raster(int columns, int rows, Value value)
      : width(columns),
        height(rows),
        values(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), value) {}
  Value& at(int column, int row) {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
  }
};

/// Some of an image's pixels: most images have many objects, each in few of their pixels.
struct Mask {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> pixels;  ///< row x width + column, ascending, each once
};

/// The part of the scanner's image that is written. The bin's window is the same for all scenes of a data set: it covers
/// the bin, and cuts off what of a tube looks past it.
enum class ImageRegion { full, bin };

/// In which pixel of the image each point lies.
class SceneImage {
 public:
  /// Points without a pixel of their own (not organized) go to the pixel that their ray passes. Throws IoError where
  /// the cloud contradicts the record.
  SceneImage(const SceneToExport& scene, ImageRegion region);

  const scene::Camera& camera() const { return camera_; }
  int width() const { return region_.width; }
  int height() const { return region_.height; }
  /// Of this image; its pixels have their centres at halves.
  Eigen::Matrix3d intrinsics() const { return camera_.intrinsics(region_); }
  /// Along the optical axis, in units of the scanner's scene::DepthScale; 0 where nothing was seen.
  Raster<std::uint16_t> depths() const;
  /// Where each tube is seen; of tube k at [k - 1].
  std::vector<Mask> visible_masks() const;
  /// Three bytes a pixel: grey tubes in a darker bin, lit from the scanner, black where nothing was seen.
  std::vector<std::uint8_t> shaded_rgb() const;
  /// Of pixels of the full image, row by row.
  Mask mask_of(const std::vector<scan::SeenPixel>& pixels) const;

 private:
  /// Whether this image has the full image's pixel.
  bool has(int column, int row) const;

  const SceneToExport& scene_;
  scene::Camera camera_;
  scene::PixelWindow region_;
  Raster<int> points_;  // index into the cloud, -1: none
};

/// Smallest box around the mask's pixels: x, y, width, height; -1 -1 -1 -1 where there are none.
struct PixelBox {
  int x = -1;
  int y = -1;
  int width = -1;
  int height = -1;
};
PixelBox box_of(const Mask& mask);

}  // namespace tubebin::exports
