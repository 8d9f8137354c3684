// What a far away light sees: the depth of the nearest surface along parallel rays, over a square.
#pragma once

#include <span>
#include <vector>

#include "render/mesh.hpp"

namespace tubebin::render {

/// The ball that holds the scene.
struct Ball {
  Eigen::Vector3f center;
  float radius = 0.0F;
};

struct DepthMap {
  Eigen::Vector3f to_light;  ///< unit
  Eigen::Matrix4f
      map_from_world;         ///< of the ball: place in the square (x, y) and depth away from the light (z), in [0, 1]
  std::vector<float> depths;  ///< row by row; a little farther than the surfaces, so that none shadows itself
};

/// Of the light from each of these directions. No OffscreenContext may live.
std::vector<DepthMap> draw_depth_maps(std::span<const Eigen::Vector3f> to_lights, int pixels, const Ball& ball,
                                      std::span<const Mesh> casters);

}  // namespace tubebin::render
