#include "modeling/input/flat_regions.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "modeling/median.hpp"

namespace tubebin::modeling {
namespace {

/// Sums over points.
struct RegionMoments {
  double count = 0.0;
  Vec3 sum = Vec3::Zero();
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;

  void add(const Vec3& p) {
    count += 1.0;
    sum += p;
    xx += p.x() * p.x(), xy += p.x() * p.y(), xz += p.x() * p.z();
    yy += p.y() * p.y(), yz += p.y() * p.z(), zz += p.z() * p.z();
  }
  RegionMoments& operator+=(const RegionMoments& other) {
    count += other.count;
    sum += other.sum;
    xx += other.xx, xy += other.xy, xz += other.xz, yy += other.yy, yz += other.yz, zz += other.zz;
    return *this;
  }
  Vec3 mean() const { return sum / count; }
  Eigen::Matrix3d covariance() const {
    Eigen::Matrix3d products;
    products << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return products / count - mean() * mean().transpose();
  }
};

/// The plane of least squares through a set of points.
struct FittedPlane {
  Vec3 center = Vec3::Zero(), normal = Vec3::Zero();
  double mean_square = std::numeric_limits<double>::infinity();  ///< of the points' distances, square metres

  FittedPlane() = default;
  explicit FittedPlane(const RegionMoments& moments) : center(moments.mean()) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.computeDirect(moments.covariance());
    normal = eigen.eigenvectors().col(0);
    mean_square = std::max(eigen.eigenvalues()(0), 0.0);
  }
};

/// Points of a block in each direction, where the whole of it is measured.
constexpr double kBlock = 4.0;
/// How far off a region's plane, in spacings, the middle of a block may be beside its noise.
constexpr double kOnPlane = 0.15;
/// A block counts with this many of its sixteen points.
constexpr double kLeastPoints = 6.0;

/// The view in square blocks, and the plane through each one's points.
class Blocks {
 public:
  Blocks(std::span<const cloud::Point> points, const ViewProjection::Images& images, double spacing, const Vec3& origin,
         const Vec3& viewpoint)
      : viewpoint_(viewpoint - origin) {
    float u_max = -std::numeric_limits<float>::infinity(), v_max = u_max;
    u_min_ = v_min_ = -u_max;
    for (std::size_t i = 0; i < images.size(); ++i) {
      u_min_ = std::min(u_min_, images.u[i]), u_max = std::max(u_max, images.u[i]);
      v_min_ = std::min(v_min_, images.v[i]), v_max = std::max(v_max, images.v[i]);
    }
    std::vector<float> ranges = images.range;
    angle_ = spacing / median(ranges);
    const double most_blocks = 1 << 22;
    const double block =
        std::max(kBlock * angle_, std::sqrt(double(u_max - u_min_) * double(v_max - v_min_) / most_blocks));
    inverse_block_ = static_cast<float>(1.0 / block);
    columns_ = static_cast<int>((u_max - u_min_) * inverse_block_) + 1;
    rows_ = static_cast<int>((v_max - v_min_) * inverse_block_) + 1;
    moments_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (std::size_t i = 0; i < points.size(); ++i)
      moments_[block_of(images, i)].add(points[i].cast<double>() - origin);
    planes_.resize(moments_.size());
    for (std::size_t b = 0; b < moments_.size(); ++b)
      if (moments_[b].count >= kLeastPoints) planes_[b] = FittedPlane(moments_[b]);
  }

  std::size_t block_of(const ViewProjection::Images& images, std::size_t i) const {
    return static_cast<std::size_t>(static_cast<int>((images.v[i] - v_min_) * inverse_block_)) *
               static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>((images.u[i] - u_min_) * inverse_block_);
  }
  std::size_t size() const { return moments_.size(); }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  const RegionMoments& moments(std::size_t block) const { return moments_[block]; }
  const FittedPlane& plane(std::size_t block) const { return planes_[block]; }
  bool has_plane(std::size_t block) const { return std::isfinite(planes_[block].mean_square); }
  /// The median of the points' standard deviations from their blocks' planes, metres; 0 without blocks.
  double roughness() const {
    std::vector<double> variances;
    for (std::size_t b = 0; b < size(); ++b)
      if (has_plane(b)) variances.push_back(planes_[b].mean_square * moments_[b].count / (moments_[b].count - 3.0));
    return variances.empty() ? 0.0 : std::sqrt(median(variances));
  }
  /// Metres between neighbouring points of the block, square to the view.
  double spacing(std::size_t block) const { return angle_ * (planes_[block].center - viewpoint_).norm(); }

 private:
  Vec3 viewpoint_;  ///< as the points, from the origin of the moments
  float u_min_, v_min_, inverse_block_;
  int columns_, rows_;
  double angle_;
  std::vector<RegionMoments> moments_;
  std::vector<FittedPlane> planes_;
};

/// A square of kSize by kSize blocks, and how far its points are off planes.
template <int kSize>
class Window {
 public:
  Window(const Blocks& blocks, int row, int column) {
    for (int k = 0; k < kSize * kSize; ++k) {
      members_[k] = static_cast<std::size_t>((row + k / kSize) * blocks.columns() + column + k % kSize);
      is_measured_ = is_measured_ && blocks.has_plane(members_[k]);
    }
    if (!is_measured_) return;
    for (const std::size_t block : members_) {
      within_ += blocks.plane(block).mean_square * blocks.moments(block).count;
      moments_ += blocks.moments(block);
    }
    plane_ = FittedPlane(moments_);
  }

  bool is_measured() const { return is_measured_; }
  const std::array<std::size_t, kSize * kSize>& members() const { return members_; }
  const FittedPlane& plane() const { return plane_; }
  /// The variance of the points about the window's plane, which takes three degrees of freedom, square metres.
  double variance() const { return plane_.mean_square * moments_.count / (moments_.count - 3.0); }
  /// The variance of the points about their blocks' planes, square metres.
  double variance_within_blocks() const { return within_ / (moments_.count - 3.0 * double(kSize * kSize)); }

 private:
  std::array<std::size_t, kSize * kSize> members_;
  bool is_measured_ = true;
  RegionMoments moments_;
  double within_ = 0.0;
  FittedPlane plane_;
};

/// How many times the noise's variance is that within blocks, whose planes follow the noise where neighbours share it
/// (scanners smooth): the median over windows of two by two blocks on surfaces that are flat over four by four.
double noise_beyond_blocks(const Blocks& blocks) {
  constexpr std::size_t kFew = 20;
  std::vector<double> ratios;
  for (int row = 0; row + 3 < blocks.rows(); row += 2)
    for (int column = 0; column + 3 < blocks.columns(); column += 2) {
      const Window<4> whole(blocks, row, column);
      if (!whole.is_measured()) continue;
      double variance = 0.0;
      for (const int r : {row, row + 2})
        for (const int c : {column, column + 2}) variance += Window<2>(blocks, r, c).variance() / 4.0;
      if (whole.variance() < 1.4 * variance) ratios.push_back(variance / whole.variance_within_blocks());
    }
  return ratios.size() < kFew ? 1.0 : std::max(median(ratios), 1.0);
}

/// The flattest window of two by two blocks that each block is part of: where it is no less flat than its blocks are,
/// the surface is a plane there.
class FlatWindows {
 public:
  explicit FlatWindows(const Blocks& blocks)
      : noise_beyond_blocks_(modeling::noise_beyond_blocks(blocks)), best_(blocks.size()) {
    for (int row = 0; row + 1 < blocks.rows(); ++row)
      for (int column = 0; column + 1 < blocks.columns(); ++column) look_at(blocks, row, column);
  }

  bool is_flat(std::size_t block) const { return std::isfinite(best_[block].mean_square); }
  const FittedPlane& plane(std::size_t block) const { return best_[block]; }
  double noise_beyond_blocks() const { return noise_beyond_blocks_; }

 private:
  void look_at(const Blocks& blocks, int row, int column) {
    const Window<2> window(blocks, row, column);
    if (!window.is_measured()) return;
    const double spacing = blocks.spacing(window.members().front());
    const double noise = noise_beyond_blocks_ * window.variance_within_blocks();
    // A parabola x^2 / 2 r over a width w is w^2 / (27 r) off its best line, root mean square: eight spacings of a
    // surface with r = 80 spacings make 0.03 spacings, noise apart. The noise of 64 points varies by a sixth.
    if (window.variance() > 1.4 * noise + 0.0009 * spacing * spacing) return;
    if (window.plane().mean_square > 0.25 * spacing * spacing) return;
    for (const std::size_t b : window.members())
      if (window.plane().mean_square < best_[b].mean_square) best_[b] = window.plane();
  }

  double noise_beyond_blocks_;
  std::vector<FittedPlane> best_;
};

/// Blocks that lie on one plane.
class Region {
 public:
  RegionMoments moments;
  FittedPlane plane;
  double within = 0.0;  ///< sum of the squares of the points' distances to their own blocks' planes
  std::vector<std::uint32_t> blocks;

  void add(const Blocks& all, std::uint32_t block) {
    blocks.push_back(block);
    moments += all.moments(block);
    within += all.plane(block).mean_square * all.moments(block).count;
  }
  /// What is wider than any strip of a tube may be warped. What is narrower has to be flatter than a strip of the thickest
  /// tube, and of so many points that they can tell.
  bool is_flat(const Blocks& all, const FlatWindows& windows) const {
    const double spacing = all.spacing(blocks.front());
    const double noise =
        windows.noise_beyond_blocks() * within / (moments.count - 3.0 * static_cast<double>(blocks.size()));
    const double across = width(spacing);
    // Within h of a plane, a tube's strip is 2 sqrt(2 r h) wide.
    const double strip = 2.0 * std::sqrt(2.0 * kThickest * spacing * 2.0 * (std::sqrt(noise) + kOnPlane * spacing));
    if (across > 1.5 * strip) return plane.mean_square < 2.5 * noise + 0.001 * spacing * spacing;
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

/// Grows regions from block to block, the surest first.
class RegionGrower {
 public:
  RegionGrower(const Blocks& blocks, const FlatWindows& windows)
      : blocks_(blocks), windows_(windows), is_taken_(blocks.size(), false) {}

  std::vector<Region> grow_all() {
    std::vector<Region> regions;
    for (const std::uint32_t seed : seeds()) {
      if (is_taken_[seed]) continue;
      Region region = grow(seed);
      if (region.blocks.size() >= kLeastBlocks && region.is_flat(blocks_, windows_)) {
        regions.push_back(std::move(region));
      } else {
        for (const std::uint32_t block : region.blocks) is_taken_[block] = false;
      }
    }
    return regions;
  }

 private:
  static constexpr std::size_t kLeastBlocks = 12;

  /// Flat blocks among flat ones that agree with them: one at an edge may lean.
  std::vector<std::uint32_t> seeds() const {
    std::vector<std::uint32_t> seeds;
    for (std::uint32_t block = 0; block < blocks_.size(); ++block) {
      if (!windows_.is_flat(block)) continue;
      int agreeing = 0;
      for_each_neighbor(block, [&](std::uint32_t next) {
        agreeing += windows_.is_flat(next) && lies_on(next, windows_.plane(block));
      });
      if (agreeing >= 5) seeds.push_back(block);
    }
    return seeds;
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
    if (std::abs(windows_.plane(block).normal.dot(plane.normal)) < kParallel) return false;
    const double off = std::abs((blocks_.plane(block).center - plane.center).dot(plane.normal));
    return off < std::sqrt(plane.mean_square) + kOnPlane * blocks_.spacing(block);
  }

  Region grow(std::uint32_t seed) {
    std::vector<std::uint32_t> front = {seed};
    Region region{.moments = {}, .plane = windows_.plane(seed), .within = 0.0, .blocks = {}};
    is_taken_[seed] = true;
    std::size_t refit_at = 8;
    for (std::size_t k = 0; k < front.size(); ++k) {
      region.add(blocks_, front[k]);
      if (k + 1 == refit_at) {
        region.plane = FittedPlane(region.moments);
        refit_at += refit_at / 2;
      }
      for_each_neighbor(front[k], [&](std::uint32_t next) {
        if (is_taken_[next] || !windows_.is_flat(next) || !lies_on(next, region.plane)) return;
        is_taken_[next] = true;
        front.push_back(next);
      });
    }
    region.plane = FittedPlane(region.moments);
    return region;
  }

  const Blocks& blocks_;
  const FlatWindows& windows_;
  std::vector<bool> is_taken_;
};

/// Tubes cut a floor into many regions of one plane.
std::vector<Region> merge_coplanar(std::vector<Region> regions, const Blocks& blocks, const FlatWindows& windows) {
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

FlatRegion flat_region(const Region& region, const Blocks& blocks, const Vec3& origin, const Vec3& viewpoint) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(region.moments.covariance());
  FlatRegion flat;
  flat.plane.normal = region.plane.normal;
  flat.center = region.plane.center + origin;
  if ((viewpoint - flat.center).dot(flat.plane.normal) < 0.0) flat.plane.normal = -flat.plane.normal;
  flat.plane.offset = flat.plane.normal.dot(flat.center);
  flat.noise = std::sqrt(region.plane.mean_square);
  // A scan without noise still has rounded numbers.
  flat.tolerance = 4.0 * flat.noise + 0.05 * blocks.spacing(region.blocks.front());
  for (int k = 0; k < 2; ++k) {
    flat.axes[k] = eigen.eigenvectors().col(2 - k);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::uint32_t b : region.blocks) {
      const double along = (blocks.plane(b).center - region.plane.center).dot(flat.axes[k]);
      low = std::min(low, along), high = std::max(high, along);
    }
    flat.center += 0.5 * (low + high) * flat.axes[k];
    flat.half_extents[k] = 0.5 * (high - low) + kBlock / 2.0 * blocks.spacing(region.blocks.front());
  }
  flat.area = 4.0 * flat.half_extents[0] * flat.half_extents[1];
  return flat;
}

/// Blocks in which planes show beside the noise: where that is as wide as the spacing, larger ones.
Blocks blocks_beyond_noise(std::span<const cloud::Point> points, const ViewProjection::Images& images, double spacing,
                           const Vec3& origin, const Vec3& viewpoint) {
  constexpr double kNoise = 0.4;  // spacings
  Blocks blocks(points, images, spacing, origin, viewpoint);
  if (blocks.roughness() < kNoise * spacing) return blocks;
  // Within three by three points even tubes of three spacings' radius are nearly flat, and what is rough is noise.
  const double noise = Blocks(points, images, 0.75 * spacing, origin, viewpoint).roughness();
  return noise < kNoise * spacing ? blocks : Blocks(points, images, noise / kNoise, origin, viewpoint);
}

}  // namespace

bool FlatRegion::holds(const Vec3& point, double margin) const {
  return std::abs(plane.height(point)) < tolerance && spans(point, margin);
}

bool FlatRegion::spans(const Vec3& point, double margin) const {
  const Vec3 offset = point - center;
  return std::abs(offset.dot(axes[0])) < half_extents[0] + margin &&
         std::abs(offset.dot(axes[1])) < half_extents[1] + margin;
}

std::vector<FlatRegion> find_flat_regions(const ViewProjection& projection, std::span<const cloud::Point> points,
                                          const ViewProjection::Images& images, double spacing) {
  if (points.empty()) return {};
  const Vec3 origin = points[points.size() / 2].cast<double>(), viewpoint = projection.viewpoint().cast<double>();
  const Blocks blocks = blocks_beyond_noise(points, images, spacing, origin, viewpoint);
  const FlatWindows windows(blocks);
  std::vector<FlatRegion> flat;
  for (const Region& region : merge_coplanar(RegionGrower(blocks, windows).grow_all(), blocks, windows)) {
    FlatRegion found = flat_region(region, blocks, origin, viewpoint);
    // Longer than the thickest tube there may be is wide: a tube's flat end is no wall.
    if (found.half_extents[0] > 42.0 * blocks.spacing(region.blocks.front())) flat.push_back(found);
  }
  std::ranges::sort(flat, [](const FlatRegion& a, const FlatRegion& b) { return a.area > b.area; });
  return flat;
}

}  // namespace tubebin::modeling
