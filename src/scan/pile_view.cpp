// Counts without images: in each row of the image a convex solid shows one run of pixels, whose two ends are all that an
// amodal count needs. Depths are looked at only where two tubes, or a tube and a part of the bin, share a pixel.
#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include "scan/occlusion_counter.hpp"
#include "scan/solid_outline.hpp"
#include "tubebin/scan/visibility.hpp"

namespace tubebin::scan {
namespace {

/// A run of pixels in which a solid appears, by its place among its tube's.
struct Run {
  int row = 0;
  Columns columns;
  cloud::Label label = 0;
  std::uint32_t solid = 0;  ///< cylinders first, then spheres
};

template <typename Solid>
class RunFinder {
 public:
  RunFinder(const Solid& solid, const scene::Camera& camera) : solid_(solid), camera_(camera) {}

  /// The pixels of the row within `bounds` in which the solid appears; rows ascend. A row's ends are looked for from where
  /// those of the rows before lead.
  Columns find(int row, const Columns& bounds) {
    row_ = row;
    Columns found = {std::clamp(guess_.begin, bounds.begin, bounds.end), 0};
    if (found.begin < bounds.end && is_hit(found.begin)) {
      while (found.begin > bounds.begin && is_hit(found.begin - 1)) --found.begin;
    } else {
      found.begin = first_hit(found.begin, bounds);
    }
    if (found.begin == bounds.end) return {};
    found.end = std::clamp(guess_.end, found.begin + 1, bounds.end);
    if (is_hit(found.end - 1)) {
      while (found.end < bounds.end && is_hit(found.end)) ++found.end;
    } else {
      do --found.end;
      while (!is_hit(found.end - 1));  // ends at found.begin, which is hit
    }
    guess_ = {2 * found.begin - last_.begin, 2 * found.end - last_.end};
    if (last_.end == 0) guess_ = found;
    last_ = found;
    return found;
  }

 private:
  /// The first hit to the right of a column that is none, else the first of all, else bounds.end.
  int first_hit(int from, const Columns& bounds) const {
    for (int column = from + 1; column < bounds.end; ++column)
      if (is_hit(column)) return column;
    // Everything to the right is missed, so the run, if there is one, ends before `from`.
    int column = std::min(from, bounds.end) - 1;
    while (column >= bounds.begin && !is_hit(column)) --column;
    if (column < bounds.begin) return bounds.end;
    while (column > bounds.begin && is_hit(column - 1)) --column;
    return column;
  }

  bool is_hit(int column) const { return !solid_.intersect(camera_.pixel_direction_in_world(column, row_)).empty(); }

  const Solid& solid_;
  const scene::Camera& camera_;
  int row_ = 0;
  Columns guess_, last_;
};

template <typename Outline, typename Solid>
void add_runs(const Labelled<Solid>& labelled, std::uint32_t index, const scene::Camera& camera, double depth_min,
              std::vector<Run>& runs) {
  const Outline outline(labelled.solid, camera, depth_min);
  RunFinder<Solid> finder(labelled.solid, camera);
  for (int row = outline.window().y; row < outline.window().y + outline.window().height; ++row) {
    const Columns bounds = outline.columns(row);
    if (bounds.begin >= bounds.end) continue;
    const Columns columns = finder.find(row, bounds);
    if (columns.begin < columns.end) runs.push_back({row, columns, labelled.label, index});
  }
}

/// The runs of all tubes' solids by rows, those of a row by labels.
std::vector<Run> find_runs(const std::vector<SceneSolids>& tubes, const scene::Camera& camera, double depth_min) {
  std::vector<Run> runs;
  for (const SceneSolids& tube : tubes) {
    std::uint32_t index = 0;
    for (const auto& cylinder : tube.cylinders) add_runs<CylinderOutline>(cylinder, index++, camera, depth_min, runs);
    for (const auto& sphere : tube.spheres) add_runs<SphereOutline>(sphere, index++, camera, depth_min, runs);
  }
  std::vector<std::size_t> begins(static_cast<std::size_t>(camera.height()) + 1, 0);
  for (const Run& run : runs) ++begins[static_cast<std::size_t>(run.row) + 1];
  for (std::size_t row = 1; row < begins.size(); ++row) begins[row] += begins[row - 1];
  std::vector<Run> sorted(runs.size());
  for (const Run& run : runs) sorted[begins[static_cast<std::size_t>(run.row)]++] = run;
  return sorted;
}

/// How deep a tube's surface may lie in the pixels of one of its solids, metres. A ray enters through a side whose normal
/// n faces it, so the surface is at most a radius times the sine of the ray's angle to the optical axis deeper than the
/// solid's axis; it enters through the flat cap of a free end only if that faces the scanner.
class DeepestSurface {
 public:
  explicit DeepestSurface(const scene::Camera& camera)
      : axis_(camera.world_from_scanner().linear().col(2)),
        sine_(std::sin(std::acos(1.0 / camera.direction_in_world(0.0, 0.0).norm()))) {}

  double of(const SolidSphere& sphere) const {
    return axis_.dot(sphere.center()) + sphere.radius() * sine_ + kRounding;
  }

  double of(const SolidCylinder& cylinder, const std::vector<Labelled<SolidSphere>>& joints) const {
    return std::max(of_end(cylinder, cylinder.base(), -cylinder.axis(), joints),
                    of_end(cylinder, cylinder.top(), cylinder.axis(), joints));
  }

 private:
  static constexpr double kRounding = 1e-9;

  double of_end(const SolidCylinder& cylinder, const Vec3& end, const Vec3& outward,
                const std::vector<Labelled<SolidSphere>>& joints) const {
    const auto is_here = [&](const auto& joint) { return (joint.solid.center() - end).norm() < kRounding; };
    const bool is_seen_cap = outward.dot(end) < kRounding && std::ranges::none_of(joints, is_here);
    return axis_.dot(end) + cylinder.radius() * (is_seen_cap ? 1.0 : sine_) + kRounding;
  }

  Vec3 axis_;
  double sine_;
};

/// Counts one row of the image after the other.
class RowCounter {
 public:
  RowCounter(const scene::Scene& scene, const std::vector<SceneSolids>& tubes, const scene::Camera& camera)
      : tubes_(tubes), camera_(camera), occlusions_(scene, camera), columns_(static_cast<std::size_t>(camera.width())) {
    view_.amodal_pixels.assign(tubes.size(), 0);
    const DeepestSurface deepest(camera);
    for (const SceneSolids& tube : tubes) {
      deepest_.emplace_back();
      for (const auto& cylinder : tube.cylinders) deepest_.back().push_back(deepest.of(cylinder.solid, tube.spheres));
      for (const auto& sphere : tube.spheres) deepest_.back().push_back(deepest.of(sphere.solid));
    }
  }

  /// `runs`: all of one row.
  void count(std::span<const Run> runs) {
    layers_.clear();
    for (const Run& run : runs) mark(run);
    for (const Run& run : runs) measure(run);
    for (const Run& run : runs)
      for (int column = run.columns.begin; column < run.columns.end; ++column) compare_once(column, run.row);
  }

  PileView result() {
    view_.occlusions = occlusions_.occlusions();
    return std::move(view_);
  }

 private:
  static constexpr std::int32_t kNoLayer = -1;

  /// What is known of a column in the current row.
  struct Column {
    cloud::Label last = 0;        ///< tube that was marked last
    std::uint32_t tubes = 0;      ///< that appear here
    bool may_be_behind = false;   ///< the bin, or what stands around, may be before a tube
    std::int32_t top = kNoLayer;  ///< in layers_, of the tube that was measured last
  };

  struct ListedLayer {
    Layer layer;
    std::int32_t next = kNoLayer;  ///< of the same column
  };

  Column& at(int column) { return columns_[static_cast<std::size_t>(column)]; }
  Layer& top_layer(const Column& column) { return layers_[static_cast<std::size_t>(column.top)].layer; }

  void mark(const Run& run) {
    std::size_t pixels = 0;
    for (int i = run.columns.begin; i < run.columns.end; ++i) {
      Column& column = at(i);
      if (column.last == run.label) continue;
      column.last = run.label;
      ++column.tubes;
      ++pixels;
    }
    view_.amodal_pixels[run.label - 1] += pixels;
    const double deepest = deepest_[run.label - 1][run.solid];
    for (const BinFront::Part& part : occlusions_.bin().parts()) {
      const scene::PixelWindow& window = part.window;
      if (part.nearest_depth > deepest || run.row < window.y || run.row >= window.y + window.height) continue;
      for (int i = std::max(run.columns.begin, window.x); i < std::min(run.columns.end, window.x + window.width); ++i)
        at(i).may_be_behind = true;
    }
  }

  /// Depths, where more than one body may be.
  void measure(const Run& run) {
    const SceneSolids& tube = tubes_[run.label - 1];
    const std::size_t cylinders = tube.cylinders.size();
    for (int i = run.columns.begin; i < run.columns.end; ++i) {
      Column& column = at(i);
      if (column.tubes < 2 && !column.may_be_behind) continue;
      const Vec3 direction = camera_.pixel_direction_in_world(i, run.row);
      const double depth = (run.solid < cylinders ? tube.cylinders[run.solid].solid.intersect(direction)
                                                  : tube.spheres[run.solid - cylinders].solid.intersect(direction))
                               .begin;
      if (column.top != kNoLayer && top_layer(column).label == run.label) {
        top_layer(column).depth = std::min(top_layer(column).depth, depth);
      } else {
        layers_.push_back({{run.label, depth}, column.top});
        column.top = static_cast<std::int32_t>(layers_.size()) - 1;
      }
    }
  }

  /// And makes the column ready for the next row.
  void compare_once(int i, int row) {
    Column& column = at(i);
    if (column.top != kNoLayer) {
      here_.clear();
      for (std::int32_t k = column.top; k != kNoLayer; k = layers_[static_cast<std::size_t>(k)].next)
        here_.push_back(layers_[static_cast<std::size_t>(k)].layer);
      occlusions_.count(here_, i, row);
    }
    column = {};
  }

  const std::vector<SceneSolids>& tubes_;
  const scene::Camera& camera_;
  OcclusionCounter occlusions_;
  std::vector<std::vector<double>> deepest_;  // of each tube's solids
  std::vector<Column> columns_;
  std::vector<ListedLayer> layers_;  // of the current row
  std::vector<Layer> here_;          // of the current column
  PileView view_;
};

/// Whether each tube's first surface along a ray is where that enters the first of the tube's solids, within range.
bool is_plain(const std::vector<SceneSolids>& tubes, const scene::Camera& camera, const scene::Scanner& scanner) {
  return std::ranges::all_of(tubes, [&](const SceneSolids& tube) {
    return !is_hollow(tube) && !begins_before(tube, camera, scanner.range_min) &&
           !ends_beyond(tube, camera, scanner.range_max);
  });
}

PileView count_pixels(const scene::Scene& scene) {
  const auto views = view_tubes_alone(scene);
  PileView pile;
  for (const auto& view : views) pile.amodal_pixels.push_back(view.size());
  pile.occlusions = find_occlusions(scene, views);
  return pile;
}

PileView view_from_one(const scene::Scene& scene) {
  const scene::Camera camera(scene.scanner);
  const std::vector<SceneSolids> tubes = solids_by_tube(scene, scene_solids(scene));
  if (!is_plain(tubes, camera, scene.scanner)) return count_pixels(scene);
  const std::vector<Run> runs = find_runs(tubes, camera, scene.scanner.range_min);
  RowCounter counter(scene, tubes, camera);
  for (std::size_t begin = 0, end = 0; begin < runs.size(); begin = end) {
    while (end < runs.size() && runs[end].row == runs[begin].row) ++end;
    counter.count(std::span(runs).subspan(begin, end - begin));
  }
  return counter.result();
}

void add(const PileView& view, PileView& sum) {
  for (std::size_t k = 0; k < view.amodal_pixels.size(); ++k) sum.amodal_pixels[k] += view.amodal_pixels[k];
  for (const scene::Occlusion& occlusion : view.occlusions) {
    const auto place = std::ranges::lower_bound(sum.occlusions, occlusion, [](const auto& a, const auto& b) {
      return std::tie(a.behind, a.front) < std::tie(b.behind, b.front);
    });
    if (place != sum.occlusions.end() && place->behind == occlusion.behind && place->front == occlusion.front)
      place->pixels += occlusion.pixels;
    else sum.occlusions.insert(place, occlusion);
  }
}

}  // namespace

PileView view_pile(const scene::Scene& scene) {
  if (scene.further_scanners.empty()) return view_from_one(scene);
  PileView sum = view_from_one(seen_from(scene, 0));
  for (std::size_t source = 1; source < scene.source_count(); ++source)
    add(view_from_one(seen_from(scene, source)), sum);
  return sum;
}

}  // namespace tubebin::scan
