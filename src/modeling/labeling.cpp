#include "modeling/labeling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

/// A cylinder of a surface, ready for distances. At a flat end the solid stops; at the others a sphere goes on. A ball has no
/// length.
struct SolidCylinder {
  cloud::Point start, axis;  ///< axis: unit
  float length, radius;
  bool flat_start, flat_end, bridged;
  std::uint32_t surface;

  /// How far from the surface a point may lie, metres.
  float reach_of(const cloud::Point& p, const Reach& reach) const {
    if (bridged) return static_cast<float>(reach.bridged) * radius;
    // A tenth of a radius is far more than a seen tube's course is off, and keeps clear of what the tube lies on.
    // Rounded ends lie inside the flat one by up to a radius.
    const float along = (p - start).dot(axis), wide = 1.1f * radius;
    const bool is_on_axis = (p - start - along * axis).squaredNorm() < wide * wide;
    const bool is_at_end = is_on_axis && ((flat_start && along < radius) || (flat_end && along > length - radius));
    return static_cast<float>(is_at_end ? std::max(reach.end, reach.seen) : reach.seen) * radius;
  }

  /// Signed distance to the surface of this cylinder with its spheres: negative inside. The union's surface is where
  /// the least of its parts' signed distances is zero.
  float signed_distance(const cloud::Point& p) const {
    const cloud::Point offset = p - start;
    const float along = offset.dot(axis);
    const float squared = std::max(offset.squaredNorm() - along * along, 0.0f);
    if (along < 0.0f && !flat_start) return offset.norm() - radius;
    if (along > length && !flat_end) return (offset - length * axis).norm() - radius;
    const float side = std::sqrt(squared) - radius;
    float cap = -std::numeric_limits<float>::infinity();
    if (flat_start) cap = std::max(cap, -along);
    if (flat_end) cap = std::max(cap, along - length);
    if (side > 0.0f && cap > 0.0f) return std::sqrt(side * side + cap * cap);
    return std::max(side, cap);
  }
};

std::vector<SolidCylinder> solid_cylinders(const TubeSurface& surface, std::uint32_t index) {
  std::vector<SolidCylinder> cylinders;
  if (surface.nodes.size() == 1)
    cylinders.push_back({.start = surface.nodes.front().cast<float>(),
                         .axis = cloud::Point::UnitX(),
                         .length = 0.0f,
                         .radius = static_cast<float>(surface.radius),
                         .flat_start = false,
                         .flat_end = false,
                         .bridged = false,
                         .surface = index});
  for (std::size_t k = 0; k + 1 < surface.nodes.size(); ++k) {
    const Vec3 along = surface.nodes[k + 1] - surface.nodes[k];
    const double length = along.norm();
    if (length <= 0.0) continue;
    cylinders.push_back({.start = surface.nodes[k].cast<float>(),
                         .axis = (along / length).cast<float>(),
                         .length = static_cast<float>(length),
                         .radius = static_cast<float>(surface.radius),
                         .flat_start = k == 0,
                         .flat_end = k + 2 == surface.nodes.size(),
                         .bridged = surface.bridged && (*surface.bridged)[k],
                         .surface = index});
  }
  return cylinders;
}

/// Which cylinders come near each cube of space, in one run of memory a cube.
class CylinderGrid {
 public:
  CylinderGrid(const std::vector<SolidCylinder>& cylinders, float reach) {
    float widest = 0.0f;
    box_.setEmpty();
    for (const SolidCylinder& c : cylinders) {
      const float pad = c.radius + reach;
      widest = std::max(widest, pad);
      for (const cloud::Point& end : {c.start, cloud::Point(c.start + c.length * c.axis)})
        box_.extend(end - cloud::Point::Constant(pad)).extend(end + cloud::Point::Constant(pad));
    }
    // Cubes about as wide as a tube hold few cylinders each; more of them than this cost more time than larger ones.
    constexpr float kMostCubes = 1 << 18;
    const auto cubes_along = [&] { return Eigen::Array3f((box_.sizes() / cube_).array().floor() + 1.0f); };
    cube_ = widest;
    while (cubes_along().prod() > kMostCubes) cube_ *= 1.25f;
    size_ = cubes_along().cast<int>();
    const auto cubes = static_cast<std::size_t>(size_.prod());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;  // cube, cylinder
    std::vector<std::uint32_t> last_entered(cubes, UINT32_MAX);
    for (std::uint32_t i = 0; i < cylinders.size(); ++i) add(cylinders[i], i, reach, last_entered, entries);
    starts_.assign(cubes + 1, 0);
    for (const auto& [cube, cylinder] : entries) ++starts_[cube + 1];
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
    cylinders_.resize(entries.size());
    for (const auto& [cube, cylinder] : entries) cylinders_[next[cube]++] = cylinder;
  }

  std::span<const std::uint32_t> near(const cloud::Point& p) const {
    if (!box_.contains(p)) return {};
    const Eigen::Array3i at = ((p - box_.min()) / cube_).array().cast<int>().min(size_ - 1);
    const auto cube = static_cast<std::size_t>((at.z() * size_.y() + at.y()) * size_.x() + at.x());
    return {cylinders_.data() + starts_[cube], cylinders_.data() + starts_[cube + 1]};
  }

 private:
  void add(const SolidCylinder& c, std::uint32_t index, float reach, std::vector<std::uint32_t>& last_entered,
           std::vector<std::pair<std::uint32_t, std::uint32_t>>& entries) const {
    // Balls half a cube apart cover the cylinder if they are larger than it by the sagitta, under a quarter cube.
    const float step = cube_ / 2.0f;
    const float ball = c.radius + reach + cube_ / 4.0f;
    const int balls = static_cast<int>(c.length / step) + 2;
    for (int b = 0; b < balls; ++b) {
      const cloud::Point center = c.start + std::min(static_cast<float>(b) * step, c.length) * c.axis;
      const auto low = ((center - box_.min()).array() - ball) / cube_;
      const auto high = ((center - box_.min()).array() + ball) / cube_;
      const Eigen::Array3i first = low.floor().cast<int>().max(0), last = high.floor().cast<int>().min(size_ - 1);
      for (int z = first.z(); z <= last.z(); ++z)
        for (int y = first.y(); y <= last.y(); ++y)
          for (int x = first.x(); x <= last.x(); ++x) {
            const auto cube = static_cast<std::uint32_t>((z * size_.y() + y) * size_.x() + x);
            if (last_entered[cube] == index) continue;
            last_entered[cube] = index;
            entries.emplace_back(cube, index);
          }
    }
  }

  Eigen::AlignedBox3f box_;
  float cube_ = 1.0f;
  Eigen::Array3i size_;
  std::vector<std::uint32_t> starts_, cylinders_;
};

}  // namespace

std::vector<double> distances_to_surface(const TubeSurface& surface, std::span<const Vec3> points) {
  const std::vector<SolidCylinder> cylinders = solid_cylinders(surface, 0);
  std::vector<double> distances;
  for (const Vec3& point : points) {
    float nearest = std::numeric_limits<float>::infinity();
    for (const SolidCylinder& c : cylinders) nearest = std::min(nearest, c.signed_distance(point.cast<float>()));
    distances.push_back(double(nearest));
  }
  return distances;
}

namespace {

std::vector<SolidCylinder> all_cylinders(const std::vector<TubeSurface>& surfaces) {
  std::vector<SolidCylinder> cylinders;
  for (std::uint32_t s = 0; s < surfaces.size(); ++s)
    for (const SolidCylinder& c : solid_cylinders(surfaces[s], s)) cylinders.push_back(c);
  return cylinders;
}

}  // namespace

std::vector<char> within_surfaces(std::span<const cloud::Point> points, const std::vector<TubeSurface>& surfaces,
                                  double tolerance) {
  const std::vector<SolidCylinder> cylinders = all_cylinders(surfaces);
  std::vector<char> within(points.size(), false);
  if (cylinders.empty()) return within;
  const CylinderGrid grid(cylinders, static_cast<float>(tolerance));
  for_ranges_in_parallel(points.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      within[i] = std::ranges::any_of(grid.near(points[i]), [&](std::uint32_t c) {
        return cylinders[c].signed_distance(points[i]) < static_cast<float>(tolerance);
      });
  });
  return within;
}

std::vector<NearestSurface> nearest_surfaces(std::span<const cloud::Point> points,
                                             const std::vector<TubeSurface>& surfaces, const Reach& reach) {
  const std::vector<SolidCylinder> cylinders = all_cylinders(surfaces);
  std::vector<NearestSurface> nearest(points.size());
  if (cylinders.empty()) return nearest;

  const float widest = std::ranges::max_element(cylinders, {}, &SolidCylinder::radius)->radius;
  const CylinderGrid grid(cylinders, static_cast<float>(std::max({reach.seen, reach.end, reach.bridged})) * widest);
  const auto find_nearest = [&](std::size_t i) {
    nearest[i].distance = std::numeric_limits<float>::infinity();
    // A cube's cylinders are sorted, so those of one surface follow each other.
    const SolidCylinder* own = nullptr;  // the nearest of the surface's cylinders
    float least = 0.0f;
    const auto keep_if_nearest = [&] {
      if (own && std::abs(least) < std::abs(nearest[i].distance) && std::abs(least) < own->reach_of(points[i], reach))
        nearest[i] = {.surface = own->surface, .distance = least};
    };
    for (const std::uint32_t c : grid.near(points[i])) {
      const float distance = cylinders[c].signed_distance(points[i]);
      const bool is_next = !own || cylinders[c].surface != own->surface;
      if (is_next) keep_if_nearest();
      if (!is_next && distance >= least) continue;
      own = &cylinders[c];
      least = distance;
    }
    keep_if_nearest();
  };
  for_ranges_in_parallel(points.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) find_nearest(i);
  });
  return nearest;
}

}  // namespace tubebin::modeling
