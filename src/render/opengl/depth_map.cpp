#include "render/opengl/depth_map.hpp"

#include "render/opengl/draw.hpp"

namespace tubebin::render {
namespace {

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

}  // namespace

std::vector<DepthMap> draw_depth_maps(std::span<const Eigen::Vector3f> to_lights, int pixels, const Ball& ball,
                                      std::span<const Mesh> casters) {
  const OffscreenContext context(pixels, pixels);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5F, 4.0F);
  glMatrixMode(GL_PROJECTION);
  glTranslatef(-1.0F, -1.0F, -1.0F);  // clip space reaches from -1 to 1
  glScalef(2.0F, 2.0F, 2.0F);
  glMatrixMode(GL_MODELVIEW);
  std::vector<DepthMap> maps;
  for (const Eigen::Vector3f& to_light : to_lights) {
    glClear(GL_DEPTH_BUFFER_BIT);
    const Eigen::Matrix4f from_world = map_from_world(to_light, ball);
    glLoadMatrixf(from_world.data());
    for (const Mesh& mesh : casters) draw(mesh);
    maps.push_back({to_light, from_world, context.read_depths()});
  }
  return maps;
}

}  // namespace tubebin::render
