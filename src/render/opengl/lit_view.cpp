#include <algorithm>
#include <cmath>

#include "render/opengl/dome_light.hpp"
#include "render/opengl/draw.hpp"
#include "render/opengl/lit_shaders.hpp"
#include "render/opengl/shader_program.hpp"
#include "render/opengl/views.hpp"
#include "tubebin/cloud/label_colors.hpp"

namespace tubebin::render {
namespace {

constexpr Fineness kLitFineness = {.facets = 24, .cell = 0.015};
constexpr Fineness kCasterFineness = {.facets = 10};
constexpr int kSunMapPixels = 1536;
constexpr int kSamples = 2;  // of a pixel, along each of its sides
constexpr double kElevation = radians(52.0);
constexpr double kAzimuth = radians(-78.0);     // of the eye, from +x towards +y
constexpr double kFieldOfView = radians(26.0);  // vertical
constexpr double kMargin = 1.06;                // of the scene's size, left free around it
constexpr double kGlassCosine = 0.3;            // walls that face the eye more than this are glass
constexpr cloud::Color kAroundColor = 0xBFC4CB;
const Eigen::Vector3f kToSun = Eigen::Vector3f(-0.30F, -0.35F, 1.0F).normalized();

/// A look from `eye` along -backward.
struct View {
  Vec3 eye;
  Vec3 right, up, backward;
};

/// What a picture must show: the bin, the tubes and what stands around.
Eigen::AlignedBox3d scene_bounds(const scene::Scene& scene) {
  Eigen::AlignedBox3d bounds;
  bounds.extend(scene::bin_bounds(scene.bin));
  for (const scene::BinPart& part : scene::surrounding_boxes(scene)) bounds.extend(part.bounds_in_world());
  for (const scene::StandingCylinder& cylinder : scene::surrounding_cylinders(scene)) {
    const Vec3 reach(cylinder.radius, cylinder.radius, 0.0);
    bounds.extend(Vec3(cylinder.position - reach));
    bounds.extend(Vec3(cylinder.position + reach + cylinder.height * Vec3::UnitZ()));
  }
  for (const scene::PlacedTube& placed : scene.tubes)
    for (int node = 0; node < static_cast<int>(placed.tube.nodes.size()); ++node)
      for (const double side : {-1.0, 1.0})
        bounds.extend(placed.node_in_world(node) + Vec3::Constant(side * placed.tube.radius_max()));
  return bounds;
}

/// The nearest eye, in the fixed direction, that has all corners of the bounds in the picture.
View view_of(const Eigen::AlignedBox3d& bounds, double aspect) {
  View view;
  view.backward = {std::cos(kElevation) * std::cos(kAzimuth), std::cos(kElevation) * std::sin(kAzimuth),
                   std::sin(kElevation)};
  view.right = Vec3::UnitZ().cross(view.backward).normalized();
  view.up = view.backward.cross(view.right);
  const double tan_up = std::tan(kFieldOfView / 2.0) / kMargin;
  const double tan_right = tan_up * aspect;
  // Each corner keeps the eye at least so far away; along each image axis the two extreme corners decide the
  // place.
  Vec3 extreme_low = Vec3::Constant(std::numeric_limits<double>::max());
  Vec3 extreme_high = -extreme_low;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner = bounds.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
    const double along = corner.dot(view.backward);
    const Vec3 low(corner.dot(view.right) - tan_right * along, corner.dot(view.up) - tan_up * along, 0.0);
    const Vec3 high(corner.dot(view.right) + tan_right * along, corner.dot(view.up) + tan_up * along, 0.0);
    extreme_low = extreme_low.cwiseMin(low);
    extreme_high = extreme_high.cwiseMax(high);
  }
  const double far_enough = std::max((extreme_high.x() - extreme_low.x()) / (2.0 * tan_right),
                                     (extreme_high.y() - extreme_low.y()) / (2.0 * tan_up));
  view.eye = view.right * (extreme_low.x() + extreme_high.x()) / 2.0 +
             view.up * (extreme_low.y() + extreme_high.y()) / 2.0 + view.backward * far_enough;
  return view;
}

/// The inverse of the shader's encoding.
Eigen::Vector3f linear_from_encoded(cloud::Color color) {
  const auto channel = [&](int shift) {
    const float encoded = static_cast<float>(color >> shift & 0xFF) / 255.0F;
    return encoded * encoded;
  };
  return {channel(16), channel(8), channel(0)};
}

Ball ball_around(const Eigen::AlignedBox3d& bounds) {
  return {bounds.center().cast<float>(), static_cast<float>(bounds.diagonal().norm() / 2.0)};
}

enum class Wall { solid, glass };

/// Whether what a picture shows of a bin, its bounds, stands between the eye and the bin's inside.
bool hides_inside(const scene::Box& bounds, const View& view) {
  const bool upright = bounds.max().z() > 0.0;
  const Vec3 outward = Vec3(bounds.center().x(), bounds.center().y(), 0.0).normalized();
  return upright && outward.dot(view.backward) > kGlassCosine;
}

/// The walls between the eye and the bin's inside, which are glass, or the others and the floor.
Mesh bin_walls(const scene::Bin& bin, Wall kind, const View& view, const Fineness& fineness) {
  Mesh walls;
  for (const scene::BinPart& part : scene::bin_parts(bin)) {
    const bool hides = hides_inside(part.bounds_in_world(), view);
    if (hides == (kind == Wall::glass)) add_part(part, Vec3::Zero(), fineness, walls);
  }
  std::vector<scene::Triangle> triangles = scene::mesh_triangles(bin);
  std::erase_if(triangles, [&](const scene::Triangle& triangle) {
    scene::Box bounds;
    for (const Vec3& corner : triangle.corners) bounds.extend(corner);
    return hides_inside(bounds, view) != (kind == Wall::glass);
  });
  add_triangles(triangles, Vec3::Zero(), view.eye, walls);
  return walls;
}

/// What throws shadows, coarsely.
std::vector<Mesh> shadow_casters(const scene::Scene& scene, const View& view) {
  std::vector<Mesh> casters = {bin_walls(scene.bin, Wall::solid, view, kCasterFineness)};
  if (scene.surroundings) casters.push_back(surroundings_mesh(scene, Vec3::Zero(), kCasterFineness));
  for (const scene::PlacedTube& tube : scene.tubes) casters.push_back(tube_mesh(tube, Vec3::Zero(), kCasterFineness));
  return casters;
}

class LitView {
 public:
  LitView(const scene::Scene& scene, const View& view, const Eigen::AlignedBox3d& bounds, const DomeLight& dome)
      : scene_(scene), view_(view), bounds_(bounds), dome_(dome), shading_(kLitVertexShader, kLitFragmentShader) {}

  /// `aspect`: width by height.
  void draw_all(const DepthMap& sun, double aspect) {
    set_camera(aspect);
    set_sun(sun);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    const std::vector<cloud::Color> colors = cloud::label_colors(scene_.tubes.size());
    draw_lit(bin_walls(scene_.bin, Wall::solid, view_, kLitFineness), colors[0], {.alpha = 1.0F, .highlight = 0.02F});
    for (std::size_t i = 0; i < scene_.tubes.size(); ++i)
      draw_lit(tube_mesh(scene_.tubes[i], Vec3::Zero(), kLitFineness), colors[i + 1],
               {.alpha = 1.0F, .highlight = 0.10F});
    if (scene_.surroundings)
      draw_lit(surroundings_mesh(scene_, Vec3::Zero(), kLitFineness), kAroundColor,
               {.alpha = 1.0F, .highlight = 0.02F});
    draw_table();
    glEnable(GL_CULL_FACE);
    glDepthMask(GL_FALSE);
    draw_lit(bin_walls(scene_.bin, Wall::glass, view_, kLitFineness), colors[0], {.alpha = 0.22F, .highlight = 0.0F});
  }

 private:
  struct Material {
    float alpha = 1.0F;
    float highlight = 0.0F;
    float fade_begin = 1e6F;  ///< metres from the world's z axis
    float fade_end = 2e6F;
  };

  void draw_lit(Mesh mesh, cloud::Color color, const Material& material) {
    dome_.shine_on(mesh);
    shading_.set("albedo", linear_from_encoded(color));
    shading_.set("alpha", material.alpha);
    shading_.set("highlight", material.highlight);
    shading_.set("fade_begin", material.fade_begin);
    shading_.set("fade_end", material.fade_end);
    draw(mesh);
  }

  void set_camera(double aspect) {
    const double radius = bounds_.diagonal().norm();
    const double distance = (view_.eye - bounds_.center()).norm();
    const double near = std::max(distance - radius, distance / 100.0);
    const double top = near * std::tan(kFieldOfView / 2.0);
    const double right = top * aspect;
    glMatrixMode(GL_PROJECTION);
    glFrustum(-right, right, -top, top, near, distance + 4.0 * radius);
    Eigen::Matrix4d eye_from_world = Eigen::Matrix4d::Identity();
    eye_from_world.row(0).head<3>() = view_.right.transpose();
    eye_from_world.row(1).head<3>() = view_.up.transpose();
    eye_from_world.row(2).head<3>() = view_.backward.transpose();
    eye_from_world.col(3).head<3>() = -eye_from_world.topLeftCorner<3, 3>() * view_.eye;
    glMatrixMode(GL_MODELVIEW);
    glLoadMatrixd(eye_from_world.data());
  }

  void set_sun(const DepthMap& sun) {
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, kSunMapPixels, kSunMapPixels, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                 sun.depths.data());
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_R_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    shading_.set("sun_map", 0);
    shading_.set("sun_map_from_world", sun.map_from_world);
    shading_.set("shadow_margin", 2.0F * ball_around(bounds_).radius / kSunMapPixels);
    shading_.set("to_sun", sun.to_light);
    shading_.set("eye", Eigen::Vector3f(view_.eye.cast<float>()));
  }

  /// A bright table that fades into the background.
  void draw_table() {
    const double reach = bounds_.diagonal().norm() * 1.5;
    const double top = bounds_.min().z();
    Mesh table;
    add_part({.box = scene::Box(Vec3(-reach, -reach, top - 0.01), Vec3(reach, reach, top))}, Vec3::Zero(),
             {.facets = 4, .cell = reach / 60.0}, table);
    glEnable(GL_CULL_FACE);  // its dark lower side would show where the upper one fades
    draw_lit(std::move(table), 0xD5D9DF,
             {.fade_begin = static_cast<float>(reach * 0.3), .fade_end = static_cast<float>(reach * 0.7)});
    glDisable(GL_CULL_FACE);
  }

  const scene::Scene& scene_;
  const View& view_;
  const Eigen::AlignedBox3d& bounds_;
  const DomeLight& dome_;
  ShaderProgram shading_;
};

void draw_background() {
  glBegin(GL_QUADS);
  glColor3f(0.93F, 0.94F, 0.96F);
  glVertex2f(-1.0F, -1.0F);
  glVertex2f(1.0F, -1.0F);
  glColor3f(0.97F, 0.975F, 0.985F);
  glVertex2f(1.0F, 1.0F);
  glVertex2f(-1.0F, 1.0F);
  glEnd();
}

}  // namespace

Image draw_lit_view(const scene::Scene& scene, int width, int height) {
  const Eigen::AlignedBox3d bounds = scene_bounds(scene);
  const double aspect = static_cast<double>(width) / height;
  const View view = view_of(bounds, aspect);
  const std::vector<Mesh> casters = shadow_casters(scene, view);
  const DomeLight dome(ball_around(bounds), casters);
  const DepthMap sun = draw_depth_maps({&kToSun, 1}, kSunMapPixels, ball_around(bounds), casters).front();
  const OffscreenContext context(width, height, kSamples);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  draw_background();
  LitView(scene, view, bounds, dome).draw_all(sun, aspect);
  return context.read();
}

}  // namespace tubebin::render
