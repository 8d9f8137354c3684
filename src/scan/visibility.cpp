#include "tubebin/scan/visibility.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "scan/ray_caster.hpp"
#include "scan/view_window.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

/// The first surfaces of one tube, pixel by pixel of a window.
class DepthImage {
 public:
  explicit DepthImage(const PixelWindow& window)
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
  PixelWindow window_;
  std::vector<double> depths_;
};

template <typename OnPixel>
void for_each_pixel(const PixelWindow& window, const OnPixel& on_pixel) {
  for (int row = window.y; row < window.y + window.height; ++row)
    for (int column = window.x; column < window.x + window.width; ++column) on_pixel(column, row);
}

double nearest_depth(const Box& box, const Camera& camera) {
  const Vec3 axis = camera.world_from_scanner().linear().col(2);
  return axis.cwiseProduct(box.min()).cwiseMin(axis.cwiseProduct(box.max())).sum();
}

bool begins_before(const SceneSolids& solids, const Camera& camera, double depth) {
  const auto is_nearer = [&](const auto& labelled) { return nearest_depth(labelled.solid.bounds(), camera) < depth; };
  return std::ranges::any_of(solids.cylinders, is_nearer) || std::ranges::any_of(solids.spheres, is_nearer);
}

/// Whether a ray may pass through an open end.
bool is_hollow(const SceneSolids& tube) {
  return std::ranges::any_of(tube.cylinders, [](const auto& cylinder) { return cylinder.bore_radius > 0.0; });
}

/// The columns [begin, end) of a row in which a solid may appear.
struct Columns {
  int begin = 0;
  int end = 0;
};

/// The pixels in which a cylinder may appear: the hull of two rectangles, those of the balls around its ends.
class CylinderOutline {
 public:
  CylinderOutline(const SolidCylinder& cylinder, const Camera& camera, double depth_min)
      : whole_(view_window({{{cylinder, 0}}, {}, {}}, SeenBodies::tubes, camera, depth_min)) {
    const auto window_of_ball = [&](const Vec3& center) {
      return view_window({{}, {{SolidSphere(center, cylinder.radius()), 0}}, {}}, SeenBodies::tubes, camera, depth_min);
    };
    const auto is_whole = [&](const PixelWindow& w) {
      return w.x > 0 && w.y > 0 && w.x + w.width < camera.width() && w.y + w.height < camera.height() && w.width > 0;
    };
    base_ = window_of_ball(cylinder.base());
    top_ = window_of_ball(cylinder.top());
    is_hull_ = is_whole(base_) && is_whole(top_);
  }

  const PixelWindow& window() const { return whole_; }

  /// The hull is all rectangles between base (t = 0) and top (t = 1); those that meet the row are an interval of t, and
  /// the sides are linear in t.
  Columns columns(int row) const {
    const Columns all = {whole_.x, whole_.x + whole_.width};
    if (!is_hull_) return all;
    const auto between = [](int a, int b, double t) { return a + t * (b - a); };
    const double slope_up = top_.y - base_.y, slope_down = slope_up + top_.height - base_.height;
    double from = 0.0, to = 1.0;
    limit(base_.y - row - 1, slope_up, from, to);                // upper side above the row's lower border
    limit(row - base_.y - base_.height, -slope_down, from, to);  // lower side below the row's upper border
    if (from > to) return {};
    const auto left = [&](double t) { return between(base_.x, top_.x, t); };
    const auto right = [&](double t) { return between(base_.x + base_.width, top_.x + top_.width, t); };
    return {std::max(all.begin, static_cast<int>(std::floor(std::min(left(from), left(to))))),
            std::min(all.end, static_cast<int>(std::ceil(std::max(right(from), right(to)))))};
  }

 private:
  /// Keeps the t of [from, to] with value + t * slope <= 0.
  static void limit(double value, double slope, double& from, double& to) {
    if (slope > 0.0) to = std::min(to, -value / slope);
    else if (slope < 0.0) from = std::max(from, -value / slope);
    else if (value > 0.0) to = -1.0;
  }

  PixelWindow whole_;
  PixelWindow base_;
  PixelWindow top_;
  bool is_hull_ = false;
};

/// A convex solid's pixels in a row are neighbours.
template <typename Solid>
void draw_row(const Solid& solid, const Columns& columns, int row, const Camera& camera, DepthImage& image) {
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

void draw(const SolidCylinder& cylinder, const Camera& camera, double depth_min, DepthImage& image) {
  const CylinderOutline outline(cylinder, camera, depth_min);
  const PixelWindow& window = outline.window();
  for (int row = window.y; row < window.y + window.height; ++row)
    draw_row(cylinder, outline.columns(row), row, camera, image);
}

void draw(const SolidSphere& sphere, const Camera& camera, double depth_min, DepthImage& image) {
  const PixelWindow window = view_window({{}, {{sphere, 0}}, {}}, SeenBodies::tubes, camera, depth_min);
  for (int row = window.y; row < window.y + window.height; ++row)
    draw_row(sphere, {window.x, window.x + window.width}, row, camera, image);
}

/// Of a tube that lies wholly beyond range_min a ray's first surface is where it enters the first of its solids.
std::vector<SeenPixel> view_beyond(const SceneSolids& tube, const PixelWindow& window, const Camera& camera,
                                   const Scanner& scanner) {
  DepthImage image(window);
  for (const auto& cylinder : tube.cylinders) draw(cylinder.solid, camera, scanner.range_min, image);
  for (const auto& sphere : tube.spheres) draw(sphere.solid, camera, scanner.range_min, image);
  return image.seen_until(scanner.range_max + kDepthTolerance);
}

std::vector<SeenPixel> view_around(SceneSolids tube, const PixelWindow& window, const Camera& camera,
                                   const Scanner& scanner) {
  const RayCaster caster(std::move(tube), scanner.range_min, scanner.range_max);
  std::vector<SeenPixel> seen;
  for_each_pixel(window, [&](int column, int row) {
    const Hit hit = caster.first_hit(camera.pixel_direction_in_world(column, row));
    if (hit.found()) seen.push_back({column, row, hit.depth});
  });
  return seen;
}

/// Each tube's own solids, without the bin.
std::vector<SceneSolids> solids_by_tube(const Scene& scene, const SceneSolids& all) {
  std::vector<SceneSolids> by_tube(scene.tubes.size());
  for (const auto& cylinder : all.cylinders) by_tube[cylinder.label - 1].cylinders.push_back(cylinder);
  for (const auto& sphere : all.spheres) by_tube[sphere.label - 1].spheres.push_back(sphere);
  return by_tube;
}

/// The surfaces that one pixel's ray meets.
struct Layer {
  Label label = 0;
  double depth = 0.0;

  bool is_before(const Layer& other) const {
    return depth < other.depth || (depth == other.depth && label < other.label);
  }
};

PixelWindow window_around(const std::vector<std::vector<SeenPixel>>& views) {
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
      for (const SeenPixel& pixel : views[k]) layers_[next[index(pixel)]++] = {static_cast<Label>(k + 1), pixel.depth};
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

  PixelWindow window_;
  std::vector<std::uint32_t> begins_;
  std::vector<Layer> layers_;
};

/// The bin as far as it can stand before something.
class BinFront {
 public:
  BinFront(const Scene& scene, const Camera& camera)
      : camera_(camera), depth_min_(scene.scanner.range_min - kDepthTolerance) {
    for (const Box& box : scene_solids({scene.bin, scene.scanner, {}}).bin)
      boxes_.push_back({box, view_window({{}, {}, {box}}, SeenBodies::bin_and_tubes, camera, scene.scanner.range_min),
                        nearest_depth(box, camera)});
  }

  /// The bin's first surface along the pixel's ray, if it may be before `depth`; else infinity.
  double first_before(double depth, int column, int row) {
    parts_.clear();
    for (const auto& [box, window, nearest] : boxes_) {
      if (nearest > depth || column < window.x || column >= window.x + window.width || row < window.y ||
          row >= window.y + window.height)
        continue;
      const Interval inside = intersect(box, inverse_direction(camera_.pixel_direction_in_world(column, row)));
      if (!inside.empty()) parts_.push_back(inside);
    }
    return parts_.empty() ? kNowhere : first_boundary(parts_, depth_min_);
  }

 private:
  struct SeenBox {
    Box box;
    PixelWindow window;
    double nearest = 0.0;
  };

  const Camera& camera_;
  double depth_min_;
  std::vector<SeenBox> boxes_;
  std::vector<Interval> parts_;
};

}  // namespace

std::vector<std::vector<SeenPixel>> view_tubes_alone(const Scene& scene) {
  const Camera camera(scene.scanner);
  std::vector<std::vector<SeenPixel>> views;
  for (SceneSolids& tube : solids_by_tube(scene, scene_solids(scene))) {
    const PixelWindow window = view_window(tube, SeenBodies::tubes, camera, scene.scanner.range_min);
    views.push_back(is_hollow(tube) || begins_before(tube, camera, scene.scanner.range_min)
                        ? view_around(std::move(tube), window, camera, scene.scanner)
                        : view_beyond(tube, window, camera, scene.scanner));
  }
  return views;
}

std::vector<Occlusion> find_occlusions(const Scene& scene, const std::vector<std::vector<SeenPixel>>& views) {
  const Camera camera(scene.scanner);
  BinFront bin(scene, camera);
  const std::size_t bodies = views.size() + 1;
  std::vector<std::size_t> pixels(bodies * bodies, 0);  // at behind * bodies + front
  PixelLayers(views).for_each([&](int column, int row, std::span<const Layer> tubes) {
    const double deepest = std::ranges::max(tubes, {}, &Layer::depth).depth;
    const Layer walls = {0, bin.first_before(deepest, column, row)};
    for (const Layer& behind : tubes) {
      if (walls.is_before(behind)) ++pixels[behind.label * bodies];
      for (const Layer& front : tubes)
        if (front.label != behind.label && front.is_before(behind)) ++pixels[behind.label * bodies + front.label];
    }
  });
  std::vector<Occlusion> occlusions;
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (pixels[i] > 0)
      occlusions.push_back({static_cast<Label>(i % bodies), static_cast<Label>(i / bodies), pixels[i]});
  return occlusions;
}

}  // namespace tubebin
