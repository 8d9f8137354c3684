// What a far away light sees: the depth of the nearest surface along parallel rays, over a square.
#pragma once

#include <functional>
#include <vector>

#include "render/opengl/offscreen_context.hpp"

namespace tubebin::render {

/// The ball that holds the scene.
struct Ball {
  Eigen::Vector3f center;
  float radius = 0.0F;
};

/// Takes a point of the ball to its place in the light's square (x, y) and its depth away from the light (z),
/// each in [0, 1].
Eigen::Matrix4f map_from_world(const Eigen::Vector3f& to_light, const Ball& ball);

/// A depth texture that scenes are drawn into. The viewport and both matrices are left changed.
class ShadowMap {
 public:
  explicit ShadowMap(int pixels);
  ~ShadowMap();
  ShadowMap(const ShadowMap&) = delete;
  ShadowMap& operator=(const ShadowMap&) = delete;

  int pixels() const { return pixels_; }

  /// `draw_casters` draws what throws shadows. Depths are a little farther than the surfaces, so that none
  /// shadows itself.
  void draw(const Eigen::Matrix4f& map_from_world, const std::function<void()>& draw_casters);

  /// The depths, row by row, as map_from_world counts rows.
  std::vector<float> read() const;

  /// For sampler2DShadow of texture unit 0: 1 where lit, 0 in shadow, in between at the edge.
  void bind() const { glBindTexture(GL_TEXTURE_2D, texture_); }

 private:
  int pixels_;
  GLuint texture_ = 0;
  GLuint framebuffer_ = 0;
};

}  // namespace tubebin::render
