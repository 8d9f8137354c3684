#include <algorithm>

#include "render/opengl/draw.hpp"
#include "render/opengl/views.hpp"
#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::render {
namespace {

/// With so many facets a tube's outline is at most 0.1 % of its radius off, a hundredth of a pixel.
constexpr Fineness kLabelFineness = {.facets = 64};
/// Metres. OpenGL needs a near plane before the eye; the floor at exactly range_max must not be cut off by
/// rounding.
constexpr double kNearestDepth = 1e-3;
constexpr double kFarMargin = 1e-5;

/// The scanner's pinhole, restricted to the window, as an OpenGL frustum. An OpenGL eye looks along -z with y
/// up.
void set_camera(const scene::Camera& camera, const scene::Scanner& scanner, const scene::PixelWindow& window) {
  const double near = std::max(scanner.range_min, kNearestDepth);
  const double metres_per_pixel = near / camera.focal_length();
  const double left = window.x - camera.width() / 2.0;
  const double top = window.y - camera.height() / 2.0;
  glMatrixMode(GL_PROJECTION);
  glFrustum(left * metres_per_pixel, (left + window.width) * metres_per_pixel,
            -(top + window.height) * metres_per_pixel, -top * metres_per_pixel, near, scanner.range_max + kFarMargin);
  Eigen::Matrix4d eye_from_world = Eigen::Matrix4d::Identity();
  eye_from_world.topLeftCorner<3, 3>() =
      Vec3(1.0, -1.0, -1.0).asDiagonal() * camera.world_from_scanner().linear().transpose();
  glMatrixMode(GL_MODELVIEW);
  glLoadMatrixd(eye_from_world.data());  // meshes are around the scanner already
}

void set_color(cloud::Color color) {
  glColor3ub(static_cast<GLubyte>(color >> 16 & 0xFF), static_cast<GLubyte>(color >> 8 & 0xFF),
             static_cast<GLubyte>(color & 0xFF));
}

}  // namespace

Image draw_label_view(const scene::Scene& scene, const scene::PixelWindow& window) {
  const OffscreenContext context(window.width, window.height);
  glDisable(GL_DITHER);
  glEnable(GL_DEPTH_TEST);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  set_camera(scene::Camera(scene.scanner), scene.scanner, window);

  const std::vector<cloud::Color> colors = cloud::label_colors(scene.tubes.size());
  const Vec3& origin = scene.scanner.position;
  Mesh bin;
  for (const scene::BinPart& part : scene::bin_parts(scene.bin)) add_part(part, origin, kLabelFineness, bin);
  add_triangles(scene::mesh_triangles(scene.bin), origin, origin, bin);
  set_color(colors[0]);
  draw(bin);
  draw(surroundings_mesh(scene, origin, kLabelFineness));
  for (std::size_t i = 0; i < scene.tubes.size(); ++i) {
    set_color(colors[i + 1]);
    draw(tube_mesh(scene.tubes[i], origin, kLabelFineness));
  }
  return context.read();
}

}  // namespace tubebin::render
