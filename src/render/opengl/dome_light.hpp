// Light from the whole sky: what part of it each vertex gets past everything that stands in its way.
#pragma once

#include "render/mesh.hpp"
#include "render/opengl/shadow_map.hpp"

namespace tubebin::render {

class DomeLight {
 public:
  DomeLight(const Ball& ball, const std::function<void()>& draw_casters);

  /// Sets dome_light of each vertex: 1 for a free surface that faces up.
  void shine_on(Mesh& mesh) const;

 private:
  /// One of the directions that stand for the sky.
  struct Light {
    Eigen::Vector3f to_light;
    Eigen::Matrix4f map_from_world;
    std::vector<float> depths;
  };

  float seen_from(const Light& light, const Vertex& vertex) const;

  float scene_radius_;
  std::vector<Light> lights_;
};

}  // namespace tubebin::render
