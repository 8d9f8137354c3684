#include "render/opengl/dome_light.hpp"

#include <algorithm>

#include "core/golden_spiral.hpp"

namespace tubebin::render {
namespace {

constexpr int kLights = 32;
constexpr int kMapPixels = 192;

std::vector<Eigen::Vector3f> sky_directions() {
  std::vector<Eigen::Vector3f> directions;
  for (const Vec3& direction : golden_spiral(kLights, 0.0)) directions.push_back(direction.cast<float>());
  return directions;
}

}  // namespace

DomeLight::DomeLight(const Ball& ball, std::span<const Mesh> casters)
    : scene_radius_(ball.radius), lights_(draw_depth_maps(sky_directions(), kMapPixels, ball, casters)) {}

void DomeLight::shine_on(Mesh& mesh) const {
  float upward = 0.0F;
  for (const DepthMap& light : lights_) upward += light.to_light.z();
  for (Vertex& vertex : mesh.vertices) {
    float sum = 0.0F;
    for (const DepthMap& light : lights_) {
      const float facing = vertex.normal.dot(light.to_light);
      if (facing > 0.0F) sum += facing * seen_from(light, vertex);
    }
    vertex.dome_light = sum / upward;
  }
}

/// 0 or 1 at each of the four pixels around, weighted by nearness.
float DomeLight::seen_from(const DepthMap& light, const Vertex& vertex) const {
  const float pixel_size = 2.0F * scene_radius_ / kMapPixels;
  const Eigen::Vector3f lifted = vertex.position + pixel_size * vertex.normal;
  const Eigen::Vector3f place = (light.map_from_world * lifted.homogeneous()).head<3>();
  const float x = std::clamp(place.x() * kMapPixels - 0.5F, 0.0F, kMapPixels - 1.001F);
  const float y = std::clamp(place.y() * kMapPixels - 0.5F, 0.0F, kMapPixels - 1.001F);
  const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y);
  const float depth = std::min(place.z(), 1.0F);  // nothing stands in the way of what lies beyond the ball
  const auto free = [&](std::size_t c, std::size_t r) {
    return depth <= light.depths[r * kMapPixels + c] ? 1.0F : 0.0F;
  };
  const float right = x - static_cast<float>(column), above = y - static_cast<float>(row);
  return (1.0F - above) * ((1.0F - right) * free(column, row) + right * free(column + 1, row)) +
         above * ((1.0F - right) * free(column, row + 1) + right * free(column + 1, row + 1));
}

}  // namespace tubebin::render
