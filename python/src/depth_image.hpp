/// A scene's depth image as Python holds it.
#pragma once

#include <vector>

#include "bindings.hpp"
#include "tubebin/scene/depth_image.hpp"

namespace tubebin::python {

struct DepthImage {
  std::size_t height = 0;
  std::size_t width = 0;
  std::vector<float> depth;           ///< metres
  std::vector<std::uint32_t> labels;  ///< as the cloud's
  Eigen::Matrix3d intrinsics;
  Pose world_from_camera;

  DepthImage(const scene::DepthImage& image, const scene::SceneRecord& record);
};

}  // namespace tubebin::python
