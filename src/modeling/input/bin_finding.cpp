#include "modeling/input/bin_finding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "modeling/input/bin_rim.hpp"
#include "modeling/input/point_sample.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

constexpr std::size_t kSample = 40000, kDenseSample = 300000;
constexpr double kAlong = 0.985;    ///< the cosine of 10 degrees
constexpr double kOverhang = 0.02;  ///< metres that a wall may reach beyond where it should end

/// Of a wall, level and outward.
Vec3 outward_of(const FlatRegion& wall, const Vec3& up) {
  return -(wall.plane.normal - wall.plane.normal.dot(up) * up).normalized();
}

/// From a place on the floor, level along a direction, to the wall's plane.
double distance_to(const FlatRegion& wall, const Vec3& place, const Vec3& outward) {
  return -wall.plane.height(place) / wall.plane.normal.dot(outward);
}

/// Half of what the wall's rectangle measures along a direction.
double half_extent(const FlatRegion& wall, const Vec3& along) {
  return wall.half_extents[0] * std::abs(wall.axes[0].dot(along)) +
         wall.half_extents[1] * std::abs(wall.axes[1].dot(along));
}

double quantile(std::vector<double>& values, double part) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The walls at +x, -x, +y, -y; null where they are hidden.
using Walls = std::array<const FlatRegion*, 4>;

/// The bins that stand on one region.
class BinsOnFloor {
 public:
  BinsOnFloor(const FlatRegion& floor, const Background& background, std::span<const cloud::Point> points)
      : floor_(floor), up_(floor.plane.normal), spacing_(background.spacing), points_(points) {
    for (const FlatRegion& region : background.regions)
      if (std::abs(region.plane.normal.dot(up_)) < kLean && floor.plane.height(region.center) > 0.0)
        standing_.push_back(&region);
    if (standing_.size() < 2) return;
    sample_ = sample_of(points, kSample);
    for (std::size_t i = 0; i < points.size(); i += dense_stride())
      heights_.push_back(height(points[i].cast<double>()));
  }

  std::vector<BinFound> find() const {
    std::vector<BinFound> bins;
    std::vector<const FlatRegion*> used;
    for (const FlatRegion* wall : standing_) {
      if (std::ranges::find(used, wall) != used.end()) continue;
      Walls walls{};
      if (const auto bin = bin_before(*wall, walls)) {
        bins.push_back(*bin);
        used.insert(used.end(), walls.begin(), walls.end());
      }
    }
    return bins;
  }

 private:
  std::size_t dense_stride() const { return points_.size() / kDenseSample + 1; }

  double height(const Vec3& p) const { return floor_.plane.height(p); }

  std::array<Vec3, 4> directions(const Vec3& x) const { return {x, -x, up_.cross(x), x.cross(up_)}; }

  /// The nearest wall that stands along a direction from the place and looks back at it.
  const FlatRegion* nearest_wall(const Vec3& place, const Vec3& outward) const {
    const FlatRegion* nearest = nullptr;
    const Vec3 along = up_.cross(outward);
    for (const FlatRegion* wall : standing_)
      if (wall->plane.height(place) > 0.0 && outward_of(*wall, up_).dot(outward) > kAlong &&
          std::abs((place - wall->center).dot(along)) < half_extent(*wall, along) + 4.0 * kOverhang &&
          (!nearest || distance_to(*wall, place, outward) < distance_to(*nearest, place, outward)))
        nearest = wall;
    return nearest;
  }

  /// The bin of which the wall is one.
  std::optional<BinFound> bin_before(const FlatRegion& wall, Walls& walls) const {
    const Vec3 first = outward_of(wall, up_);
    const Vec3 place = wall.center - height(wall.center) * up_ - 2.0 * kOverhang * first;
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      walls[k] = nearest_wall(place, directions(first)[k]);
      if (walls[k] == nullptr) continue;
      // The walls' mean direction, of a frame with right angles.
      const Vec3 outward = outward_of(*walls[k], up_);
      sum += std::array<Vec3, 4>{outward, -outward, outward.cross(up_), up_.cross(outward)}[k];
    }
    if ((!walls[0] && !walls[1]) || (!walls[2] && !walls[3])) return std::nullopt;
    const Vec3 x = sum.normalized();
    const double top = height_of(walls);
    std::array<double, 4> distances{};
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3 outward = directions(x)[k];
      const auto distance = walls[k] ? std::optional(distance_to(*walls[k], place, outward))
                                     : distance_to_rim(*walls[k ^ 1], place, outward, top);
      if (!distance) return std::nullopt;
      distances[k] = *distance;
    }
    const BinFound bin = bin_about(place, x, distances, top);
    return floor_fills(bin) ? std::optional(bin) : std::nullopt;
  }

  BinFound bin_about(const Vec3& place, Vec3 x, std::array<double, 4> distances, double top) const {
    if (distances[0] + distances[1] < distances[2] + distances[3]) {
      distances = {distances[2], distances[3], distances[1], distances[0]};
      x = up_.cross(x);
    }
    const Vec3 y = up_.cross(x);
    BinFound bin{.world_from_bin = Pose::Identity(),
                 .length = distances[0] + distances[1],
                 .width = distances[2] + distances[3],
                 .height = top};
    bin.world_from_bin.linear() << x, y, up_;
    bin.world_from_bin.translation() =
        place - height(place) * up_ + (distances[0] - bin.length / 2.0) * x + (distances[2] - bin.width / 2.0) * y;
    return bin;
  }

  /// A table reaches beyond what stands on it, and between two bins it is seen below their floors.
  bool floor_fills(const BinFound& bin) const {
    const Pose bin_from_world = bin.world_from_bin.inverse();
    const Eigen::Array2d half(bin.length / 2.0, bin.width / 2.0);
    std::size_t inside = 0, others = 0;
    for (const Vec3& p : sample_) {
      if (height(p) > floor_.tolerance) continue;
      const Eigen::Array2d outside = (bin_from_world * p).head<2>().array().abs() - half;
      const bool is_beside = (outside > kThickestWall).any() && (outside < 2.0 * kThickestWall).all();
      if ((outside < 0.0).all()) ++(height(p) > -floor_.tolerance ? inside : others);
      else if (is_beside && height(p) > -floor_.tolerance) ++others;
    }
    return 10 * others < inside;
  }

  /// The level that most points on top of the walls lie at; where none is seen, as high as the walls are. Walls are seen at
  /// a flat angle, and their upper sides are not.
  double height_of(const Walls& walls) const {
    std::vector<double> on_walls, on_top;
    for (const Vec3& p : sample_)
      for (const FlatRegion* wall : walls) {
        if (wall == nullptr || !wall->spans(p, kOverhang)) continue;
        const double behind = -wall->plane.height(p);
        if (wall->holds(p, 0.0)) on_walls.push_back(height(p));
        else if (behind > wall->tolerance && behind < kThickestWall) on_top.push_back(height(p));
      }
    if (on_walls.empty()) return 0.0;
    const double highest = quantile(on_walls, 0.98), step = 2.0 * spacing_;
    std::map<long, std::vector<double>> levels;
    for (const double h : on_top)
      if (h > highest - kOverhang) levels[std::lround(h / step)].push_back(h);
    const auto commonest = std::ranges::max_element(levels, {}, [](const auto& level) { return level.second.size(); });
    return levels.empty() || commonest->second.size() < 20 ? highest : quantile(commonest->second, 0.5);
  }

  /// From a place to the wall across from another one, of which the scan shows the upper side alone: the nearest line of
  /// points at that height which goes along most of the wall.
  std::optional<double> distance_to_rim(const FlatRegion& opposite, const Vec3& place, const Vec3& outward,
                                        double top) const {
    constexpr double kFarthest = 3.0, kPart = 0.5;  // metres; of the wall's length
    const double step = 2.0 * spacing_, along_step = 3.0 * step;
    const Vec3 along = up_.cross(outward);
    const double half = 0.9 * half_extent(opposite, along);
    const auto columns = static_cast<std::size_t>(2.0 * half / along_step) + 1;
    std::vector<std::vector<bool>> is_seen;  // by steps from the place
    for (std::size_t k = 0; k < heights_.size(); ++k) {
      if (!(std::abs(heights_[k] - top) < kOverhang / 4.0)) continue;
      const Vec3 p = points_[k * dense_stride()].cast<double>();
      const double distance = (p - place).dot(outward), aside = (p - opposite.center).dot(along) + half;
      if (distance < 0.0 || distance >= kFarthest || aside < 0.0 || aside >= 2.0 * half) continue;
      const auto row = static_cast<std::size_t>(distance / step);
      if (row >= is_seen.size()) is_seen.resize(row + 1, std::vector<bool>(columns, false));
      is_seen[row][static_cast<std::size_t>(aside / along_step)] = true;
    }
    for (std::size_t row = 0; row < is_seen.size(); ++row) {
      const auto count = std::ranges::count(is_seen[row], true);
      if (static_cast<double>(count) < kPart * static_cast<double>(columns)) continue;
      // It leans as the wall across from it does.
      const double lean = opposite.plane.normal.dot(up_) / std::abs(opposite.plane.normal.dot(outward));
      return (static_cast<double>(row) + 0.5) * step - top * lean;
    }
    return std::nullopt;
  }

  const FlatRegion& floor_;
  const Vec3& up_;
  double spacing_;
  std::span<const cloud::Point> points_;
  std::vector<const FlatRegion*> standing_;
  std::vector<Vec3> sample_;     ///< of the points
  std::vector<double> heights_;  ///< above the floor, of every dense_stride()th point; not a number where that is none
};

std::ptrdiff_t points_in(const BinFound& bin, const Background& background, std::span<const cloud::Point> points) {
  const Pose bin_from_world = bin.world_from_bin.inverse();
  return std::ranges::count_if(background.foreground, [&](std::uint32_t i) {
    const Vec3 own = bin_from_world * points[i].cast<double>();
    return std::abs(own.x()) < bin.length / 2.0 && std::abs(own.y()) < bin.width / 2.0 && own.z() > 0.0;
  });
}

}  // namespace

std::optional<BinFound> find_bin(const Background& background, const Vec3& up, std::span<const cloud::Point> points) {
  const std::vector<BinFound> bins = gather_in_parallel(background.regions.size(), [&](std::size_t k) {
    const FlatRegion& floor = background.regions[k];
    return floor.plane.normal.dot(up) < kAlong ? std::vector<BinFound>{}
                                               : BinsOnFloor(floor, background, points).find();
  });
  std::optional<BinFound> best;
  std::ptrdiff_t most = -1;
  for (const BinFound& bin : bins) {
    const std::ptrdiff_t count = points_in(bin, background, points);
    if (count <= most) continue;
    most = count;
    best = bin;
  }
  return best;
}

}  // namespace tubebin::modeling
