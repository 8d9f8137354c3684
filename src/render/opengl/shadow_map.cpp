#include "render/opengl/shadow_map.hpp"

namespace tubebin::render {

Eigen::Matrix4f map_from_world(const Eigen::Vector3f& to_light, const Ball& ball) {
  const Eigen::Vector3f u = to_light.unitOrthogonal();
  const float scale = 0.5F / ball.radius;
  Eigen::Matrix4f map = Eigen::Matrix4f::Identity();
  map.row(0).head<3>() = scale * u.transpose();
  map.row(1).head<3>() = scale * to_light.cross(u).transpose();
  map.row(2).head<3>() = -scale * to_light.transpose();
  map.col(3).head<3>() = Eigen::Vector3f::Constant(0.5F) - map.topLeftCorner<3, 3>() * ball.center;
  return map;
}

ShadowMap::ShadowMap(int pixels) : pixels_(pixels) {
  glGenTextures(1, &texture_);
  bind();
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, pixels, pixels, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_R_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
}

ShadowMap::~ShadowMap() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteTextures(1, &texture_);
}

void ShadowMap::draw(const Eigen::Matrix4f& map_from_world, const std::function<void()>& draw_casters) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, pixels_, pixels_);
  glEnable(GL_DEPTH_TEST);
  glClear(GL_DEPTH_BUFFER_BIT);
  glMatrixMode(GL_PROJECTION);
  glLoadIdentity();
  glTranslatef(-1.0F, -1.0F, -1.0F);  // clip space reaches from -1 to 1
  glScalef(2.0F, 2.0F, 2.0F);
  glMatrixMode(GL_MODELVIEW);
  glLoadMatrixf(map_from_world.data());
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5F, 4.0F);
  draw_casters();
  glDisable(GL_POLYGON_OFFSET_FILL);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

std::vector<float> ShadowMap::read() const {
  std::vector<float> depths(static_cast<std::size_t>(pixels_) * static_cast<std::size_t>(pixels_));
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glReadPixels(0, 0, pixels_, pixels_, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return depths;
}

}  // namespace tubebin::render
