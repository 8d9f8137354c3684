#include "modeling/input/flat_regions.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

/// How far off a region's plane, in spacings, the middle of a block may be beside its noise.
constexpr double kOnPlane = 0.15;

/// Blocks that lie on one plane.
class Region {
 public:
  PointMoments moments;
  FittedPlane plane;
  double within = 0.0;  ///< sum of the squares of the points' distances to their own blocks' planes
  std::vector<std::uint32_t> blocks;

  /// Adds what is known of one of the blocks.
  void add(const FlatBlocks& all, std::uint32_t block) {
    moments += all.moments(block);
    within += all.residual(block) * all.moments(block).count;
  }
  /// What is far wider than any strip of a tube is none, however warped or wavy its scan is; what is wider may be warped a
  /// little. What is narrower has to be flatter than a strip of the thickest tube, and of so many points that they can tell.
  bool is_flat(const FlatBlocks& all, const FlatWindows& windows) const {
    const double spacing = all.spacing(blocks.front());
    const double noise =
        windows.noise_beyond_blocks() * within / (moments.count - 3.0 * static_cast<double>(blocks.size()));
    const double across = width(spacing);
    // Within h of a plane, a tube's strip is 2 sqrt(2 r h) wide.
    const auto strip = [&](double deviation) {
      return 2.0 * std::sqrt(2.0 * kThickest * spacing * 2.0 * (deviation + kOnPlane * spacing));
    };
    if (across > 6.0 * strip(std::sqrt(plane.mean_square))) return true;
    if (across > 1.5 * strip(std::sqrt(noise))) return plane.mean_square < 2.5 * noise + 0.001 * spacing * spacing;
    // A parabola x^2 / 2 r over a width w is w^2 / (27 r) off its best line, root mean square.
    const double bend = across * across / (27.0 * kThickest * spacing);
    const double excess = 0.5 * bend * bend, error = noise * std::sqrt(2.0 / moments.count);
    return 4.0 * error < excess && plane.mean_square < noise + excess;
  }

 private:
  static constexpr double kThickest = 40.0;  ///< spacings, radius of a tube

  double width(double spacing) const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moments.covariance());
    return moments.count * spacing * spacing / std::sqrt(12.0 * eigen.eigenvalues()(2));
  }
};

/// Which blocks a region in the making has reached.
class Visits {
 public:
  void begin(std::size_t blocks) {
    last_.resize(blocks, 0);
    ++turn_;
  }
  void add(std::uint32_t block) { last_[block] = turn_; }
  bool has(std::uint32_t block) const { return last_[block] == turn_; }

 private:
  std::vector<std::uint32_t> last_;  ///< of each block, the last turn that reached it
  std::uint32_t turn_ = 0;
};

/// Grows regions from block to block.
class RegionGrower {
 public:
  RegionGrower(const FlatBlocks& blocks, const FlatWindows& windows)
      : blocks_(blocks), windows_(windows), faces_(blocks.size()), is_taken_(blocks.size(), false) {
    for_ranges_in_parallel(blocks.size(), [&](std::size_t first, std::size_t last) {
      for (std::size_t b = first; b < last; ++b)
        if (windows.is_flat(b))
          faces_[b] = {blocks.moments(b).mean(), windows.plane(b).normal, kOnPlane * blocks.spacing(b)};
    });
  }

  /// As if one seed after the other grew. Most seeds on a curved surface grow no region: several grow at once, as if those
  /// before them grew none, up to the first that does.
  std::vector<Region> grow_all() {
    constexpr std::size_t kMostAtOnce = 256;
    const std::vector<std::uint32_t> seeds = this->seeds();
    std::vector<Region> regions;
    std::vector<std::size_t> tried;  // numbers of seeds
    for (std::size_t next = 0, at_once = 1; next < seeds.size();) {
      tried.clear();
      for (; next < seeds.size() && tried.size() < at_once; ++next)
        if (!is_taken_[seeds[next]]) tried.push_back(next);
      std::vector<std::optional<Region>> grown =
          map_in_parallel(tried.size(), [&](std::size_t k) { return grow(seeds[tried[k]]); });
      at_once = std::min(2 * at_once, kMostAtOnce);
      const auto found = std::ranges::find_if(grown, &std::optional<Region>::has_value);
      if (found == grown.end()) continue;
      for (const std::uint32_t block : (*found)->blocks) is_taken_[block] = true;
      regions.push_back(std::move(**found));
      next = tried[static_cast<std::size_t>(found - grown.begin())] + 1, at_once = 1;
    }
    return regions;
  }

 private:
  static constexpr std::size_t kLeastBlocks = 12;

  /// A flat block. `reach`: metres, how far from a plane that it lies on its middle may be, beside noise.
  struct Face {
    Vec3 middle = Vec3::Zero(), normal = Vec3::Zero();
    double reach = -std::numeric_limits<double>::infinity();
  };

  /// Flat blocks among flat ones that agree with them: one at an edge may lean.
  std::vector<std::uint32_t> seeds() const {
    const auto columns = static_cast<std::uint32_t>(blocks_.columns());
    return gather_in_parallel(static_cast<std::size_t>(blocks_.rows()), [&](std::size_t row) {
      std::vector<std::uint32_t> seeds_of_row;
      const std::uint32_t first = static_cast<std::uint32_t>(row) * columns;
      for (std::uint32_t block = first; block < first + columns; ++block) {
        if (!windows_.is_flat(block)) continue;
        int agreeing = 0;
        for_each_neighbor(block, [&](std::uint32_t next) { agreeing += lies_on(next, windows_.plane(block)); });
        if (agreeing >= 5) seeds_of_row.push_back(block);
      }
      return seeds_of_row;
    });
  }

  template <typename Visit>
  void for_each_neighbor(std::uint32_t block, const Visit& visit) const {
    const int row = static_cast<int>(block) / blocks_.columns(), column = static_cast<int>(block) % blocks_.columns();
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, blocks_.rows() - 1); ++r)
      for (int c = std::max(column - 1, 0); c <= std::min(column + 1, blocks_.columns() - 1); ++c)
        if (r != row || c != column) visit(static_cast<std::uint32_t>(r * blocks_.columns() + c));
  }

  bool lies_on(std::uint32_t block, const FittedPlane& plane) const {
    constexpr double kParallel = 0.99;  // the cosine of 8 degrees
    const auto& [middle, normal, reach] = faces_[block];
    return std::abs((middle - plane.center).dot(plane.normal)) < std::sqrt(plane.mean_square) + reach &&
           std::abs(normal.dot(plane.normal)) >= kParallel;
  }

  /// The region about a seed; none where it is not flat.
  std::optional<Region> grow(std::uint32_t seed) {
    Region region{.moments = {}, .plane = windows_.plane(seed), .within = 0.0, .blocks = {seed}};
    Visits& visits = visits_.local();
    visits.begin(blocks_.size());
    visits.add(seed);
    std::size_t refit_at = 8;
    for (std::size_t k = 0; k < region.blocks.size(); ++k) {
      const std::uint32_t block = region.blocks[k];
      region.add(blocks_, block);
      if (k + 1 == refit_at) {
        region.plane = FittedPlane(region.moments);
        refit_at += refit_at / 2;
      }
      for_each_neighbor(block, [&](std::uint32_t next) {
        if (is_taken_[next] || visits.has(next) || !lies_on(next, region.plane)) return;
        visits.add(next);
        region.blocks.push_back(next);
      });
    }
    if (region.blocks.size() < kLeastBlocks) return std::nullopt;
    region.plane = FittedPlane(region.moments);
    if (!region.is_flat(blocks_, windows_)) return std::nullopt;
    return region;
  }

  const FlatBlocks& blocks_;
  const FlatWindows& windows_;
  std::vector<Face> faces_;  ///< of the blocks; no plane is in reach of those that are not flat
  std::vector<bool> is_taken_;
  tbb::enumerable_thread_specific<Visits> visits_;
};

/// Tubes cut a floor into many regions of one plane.
std::vector<Region> merge_coplanar(std::vector<Region> regions, const FlatBlocks& blocks, const FlatWindows& windows) {
  std::ranges::sort(regions, [](const Region& a, const Region& b) { return a.moments.count > b.moments.count; });
  std::vector<Region> merged;
  for (Region& region : regions) {
    const auto one_plane = [&](Region& larger) {
      if (std::abs(larger.plane.normal.dot(region.plane.normal)) < 0.98) return false;
      const double off = std::abs((region.plane.center - larger.plane.center).dot(larger.plane.normal));
      if (off > 4.0 * std::sqrt(larger.plane.mean_square) + 0.1 * blocks.spacing(larger.blocks.front())) return false;
      Region both = larger;
      both.moments += region.moments;
      both.within += region.within;
      both.blocks.insert(both.blocks.end(), region.blocks.begin(), region.blocks.end());
      both.plane = FittedPlane(both.moments);
      if (!both.is_flat(blocks, windows)) return false;
      larger = std::move(both);
      return true;
    };
    if (std::ranges::none_of(merged, one_plane)) merged.push_back(std::move(region));
  }
  return merged;
}

FlatRegion flat_region(const Region& region, const FlatBlocks& blocks, const Vec3& viewpoint) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(region.moments.covariance());
  FlatRegion flat;
  flat.plane.normal = region.plane.normal;
  flat.center = region.plane.center + blocks.origin();
  if ((viewpoint - flat.center).dot(flat.plane.normal) < 0.0) flat.plane.normal = -flat.plane.normal;
  flat.plane.offset = flat.plane.normal.dot(flat.center);
  flat.noise = std::sqrt(region.plane.mean_square);
  // A scan without noise still has rounded numbers.
  flat.tolerance = 4.0 * flat.noise + 0.05 * blocks.spacing(region.blocks.front());
  for (int k = 0; k < 2; ++k) {
    flat.axes[k] = eigen.eigenvectors().col(2 - k);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::uint32_t b : region.blocks) {
      const double along = (blocks.moments(b).mean() - region.plane.center).dot(flat.axes[k]);
      low = std::min(low, along), high = std::max(high, along);
    }
    flat.center += 0.5 * (low + high) * flat.axes[k];
    flat.half_extents[k] = 0.5 * (high - low) + FlatBlocks::kPoints / 2.0 * blocks.spacing(region.blocks.front());
  }
  flat.area = 4.0 * flat.half_extents[0] * flat.half_extents[1];
  return flat;
}

}  // namespace

bool FlatRegion::holds(const Vec3& point, double margin) const { return lies_on_plane(point) && spans(point, margin); }

bool FlatRegion::spans(const Vec3& point, double margin) const {
  const Vec3 offset = point - center;
  return std::abs(offset.dot(axes[0])) < half_extents[0] + margin &&
         std::abs(offset.dot(axes[1])) < half_extents[1] + margin;
}

std::vector<FlatRegion> find_flat_regions(FlatBlocks blocks, const SourceView& view) {
  constexpr double kWidest = 4.0;  // times as wide
  FlatWindows windows(blocks);
  for (double wider = 1.0; wider < kWidest && are_tilted_by_noise(blocks, windows, wider * view.spacing.metres);) {
    wider *= 2.0;
    blocks = FlatBlocks(view, wider);
    windows = FlatWindows(blocks);
  }
  const Vec3 viewpoint = view.projection.viewpoint().cast<double>();
  std::vector<FlatRegion> flat;
  for (const Region& region : merge_coplanar(RegionGrower(blocks, windows).grow_all(), blocks, windows)) {
    FlatRegion found = flat_region(region, blocks, viewpoint);
    // Longer than the thickest tube there may be is wide: a tube's flat end is no wall.
    if (found.half_extents[0] > 42.0 * blocks.spacing(region.blocks.front())) flat.push_back(found);
  }
  std::ranges::sort(flat, [](const FlatRegion& a, const FlatRegion& b) { return a.area > b.area; });
  return flat;
}

}  // namespace tubebin::modeling
