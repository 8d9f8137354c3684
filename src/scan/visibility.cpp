#include "tubebin/scan/visibility.hpp"

#include <algorithm>
#include <span>

#include "scan/occlusion_counter.hpp"
#include "scan/solid_outline.hpp"
#include "scan/view_window.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::scan {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

/// The first surfaces of one tube, pixel by pixel of a window.
class DepthImage {
 public:
  explicit DepthImage(const scene::PixelWindow& window)
      : window_(window),
        depths_(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height), kNowhere) {}

  double& at(int column, int row) {
    return depths_[static_cast<std::size_t>(row - window_.y) * static_cast<std::size_t>(window_.width) +
                   static_cast<std::size_t>(column - window_.x)];
  }

  std::vector<SeenPixel> seen_until(double depth_max) const {
    std::vector<SeenPixel> seen;
    for (std::size_t i = 0; i < depths_.size(); ++i)
      if (depths_[i] <= depth_max)
        seen.push_back({window_.x + static_cast<int>(i) % window_.width,
                        window_.y + static_cast<int>(i) / window_.width, depths_[i]});
    return seen;
  }

 private:
  scene::PixelWindow window_;
  std::vector<double> depths_;
};

template <typename OnPixel>
void for_each_pixel(const scene::PixelWindow& window, const OnPixel& on_pixel) {
  for (int row = window.y; row < window.y + window.height; ++row)
    for (int column = window.x; column < window.x + window.width; ++column) on_pixel(column, row);
}

/// A convex solid's pixels in a row are neighbours.
template <typename Solid>
void draw_row(const Solid& solid, const Columns& columns, int row, const scene::Camera& camera, DepthImage& image) {
  bool was_hit = false;
  for (int column = columns.begin; column < columns.end; ++column) {
    const Interval inside = solid.intersect(camera.pixel_direction_in_world(column, row));
    if (inside.empty()) {
      if (was_hit) return;
      continue;
    }
    was_hit = true;
    double& depth = image.at(column, row);
    depth = std::min(depth, inside.begin);
  }
}

template <typename Outline, typename Solid>
void draw(const Solid& solid, const scene::Camera& camera, double depth_min, DepthImage& image) {
  const Outline outline(solid, camera, depth_min);
  const scene::PixelWindow& window = outline.window();
  for (int row = window.y; row < window.y + window.height; ++row)
    draw_row(solid, outline.columns(row), row, camera, image);
}

/// Of a tube that lies wholly beyond range_min a ray's first surface is where it enters the first of its solids.
std::vector<SeenPixel> view_beyond(const SceneSolids& tube, const scene::PixelWindow& window,
                                   const scene::Camera& camera, const scene::Scanner& scanner) {
  DepthImage image(window);
  for (const auto& cylinder : tube.cylinders) draw<CylinderOutline>(cylinder.solid, camera, scanner.range_min, image);
  for (const auto& sphere : tube.spheres) draw<SphereOutline>(sphere.solid, camera, scanner.range_min, image);
  return image.seen_until(scanner.range_max + kDepthTolerance);
}

std::vector<SeenPixel> view_around(SceneSolids tube, const scene::PixelWindow& window, const scene::Camera& camera,
                                   const scene::Scanner& scanner) {
  const RayCaster caster(std::move(tube), scanner.range_min, scanner.range_max);
  std::vector<SeenPixel> seen;
  for_each_pixel(window, [&](int column, int row) {
    const Hit hit = caster.first_hit(camera.pixel_direction_in_world(column, row));
    if (hit.found()) seen.push_back({column, row, hit.depth});
  });
  return seen;
}

scene::PixelWindow window_around(const std::vector<std::vector<SeenPixel>>& views) {
  Eigen::AlignedBox2i bounds;
  for (const auto& view : views)
    for (const SeenPixel& pixel : view) bounds.extend(Eigen::Vector2i(pixel.column, pixel.row));
  if (bounds.isEmpty()) return {};
  return {bounds.min().x(), bounds.min().y(), bounds.sizes().x() + 1, bounds.sizes().y() + 1};
}

/// All tubes' layers, pixel by pixel.
class PixelLayers {
 public:
  explicit PixelLayers(const std::vector<std::vector<SeenPixel>>& views)
      : window_(window_around(views)),
        begins_(static_cast<std::size_t>(window_.width) * static_cast<std::size_t>(window_.height) + 1, 0) {
    for (const auto& view : views)
      for (const SeenPixel& pixel : view) ++begins_[index(pixel) + 1];
    for (std::size_t i = 1; i < begins_.size(); ++i) begins_[i] += begins_[i - 1];
    layers_.resize(begins_.back());
    std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
    for (std::size_t k = 0; k < views.size(); ++k)
      for (const SeenPixel& pixel : views[k])
        layers_[next[index(pixel)]++] = {static_cast<cloud::Label>(k + 1), pixel.depth};
  }

  template <typename OnPixel>
  void for_each(const OnPixel& on_pixel) const {
    for (std::size_t i = 0; i + 1 < begins_.size(); ++i)
      if (begins_[i] != begins_[i + 1])
        on_pixel(window_.x + static_cast<int>(i) % window_.width, window_.y + static_cast<int>(i) / window_.width,
                 std::span(layers_).subspan(begins_[i], begins_[i + 1] - begins_[i]));
  }

 private:
  std::size_t index(const SeenPixel& pixel) const {
    return static_cast<std::size_t>(pixel.row - window_.y) * static_cast<std::size_t>(window_.width) +
           static_cast<std::size_t>(pixel.column - window_.x);
  }

  scene::PixelWindow window_;
  std::vector<std::uint32_t> begins_;
  std::vector<Layer> layers_;
};

}  // namespace

std::vector<std::vector<SeenPixel>> view_tubes_alone(const scene::Scene& scene) {
  const scene::Camera camera(scene.scanner);
  std::vector<std::vector<SeenPixel>> views;
  for (SceneSolids& tube : solids_by_tube(scene, scene_solids(scene))) {
    const scene::PixelWindow window = view_window(tube, SeenBodies::tubes, camera, scene.scanner.range_min);
    views.push_back(is_hollow(tube) || begins_before(tube, camera, scene.scanner.range_min)
                        ? view_around(std::move(tube), window, camera, scene.scanner)
                        : view_beyond(tube, window, camera, scene.scanner));
  }
  return views;
}

std::vector<scene::Occlusion> find_occlusions(const scene::Scene& scene,
                                              const std::vector<std::vector<SeenPixel>>& views) {
  const scene::Camera camera(scene.scanner);
  OcclusionCounter counter(scene, camera);
  PixelLayers(views).for_each(
      [&](int column, int row, std::span<const Layer> tubes) { counter.count(tubes, column, row); });
  return counter.occlusions();
}

}  // namespace tubebin::scan
