// Light from the whole sky: what part of it each vertex gets past everything that stands in its way.
#pragma once

#include "render/opengl/depth_map.hpp"

namespace tubebin::render {

class DomeLight {
 public:
  DomeLight(const Ball& ball, std::span<const Mesh> casters);

  /// Sets dome_light of each vertex: 1 for a free surface that faces up.
  void shine_on(Mesh& mesh) const;

 private:
  float seen_from(const DepthMap& light, const Vertex& vertex) const;

  float scene_radius_;
  std::vector<DepthMap> lights_;  ///< of the directions that stand for the sky
};

}  // namespace tubebin::render
