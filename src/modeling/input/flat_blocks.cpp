#include "modeling/input/flat_blocks.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "modeling/median.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

/// A block counts with this many of its sixteen points.
constexpr double kLeastPoints = 6.0;

/// A square of kSize by kSize blocks, and how far its points are off planes.
template <int kSize>
class Window {
 public:
  Window(const FlatBlocks& blocks, int row, int column) {
    for (int k = 0; k < kSize * kSize; ++k) {
      members_[k] = static_cast<std::size_t>((row + k / kSize) * blocks.columns() + column + k % kSize);
      is_measured_ = is_measured_ && blocks.has_plane(members_[k]);
    }
    if (!is_measured_) return;
    for (const std::size_t block : members_) {
      within_ += blocks.residual(block) * blocks.moments(block).count;
      moments_ += blocks.moments(block);
    }
    residual_ = plane_residual(moments_);
  }

  bool is_measured() const { return is_measured_; }
  const std::array<std::size_t, kSize * kSize>& members() const { return members_; }
  FittedPlane plane() const { return {moments_, residual_}; }
  double residual() const { return residual_; }
  /// The variance of the points about the window's plane, which takes three degrees of freedom, square metres.
  double variance() const { return residual_ * moments_.count / (moments_.count - 3.0); }
  /// The variance of the points about their blocks' planes, square metres.
  double variance_within_blocks() const { return within_ / (moments_.count - 3.0 * double(kSize * kSize)); }

 private:
  std::array<std::size_t, kSize * kSize> members_;
  bool is_measured_ = true;
  PointMoments moments_;
  double within_ = 0.0, residual_ = 0.0;
};

/// The median over windows of two by two blocks on surfaces that are flat over four by four.
double noise_beyond_blocks(const FlatBlocks& blocks) {
  constexpr std::size_t kFew = 20;
  const auto rows = static_cast<std::size_t>(std::max(blocks.rows() - 2, 0) / 2);
  std::vector<double> ratios = gather_in_parallel(rows, [&](std::size_t k) {
    const int row = 2 * static_cast<int>(k);
    std::vector<double> ratios_of_row;
    for (int column = 0; column + 3 < blocks.columns(); column += 2) {
      const Window<4> whole(blocks, row, column);
      if (!whole.is_measured()) continue;
      double variance = 0.0;
      for (const int r : {row, row + 2})
        for (const int c : {column, column + 2}) variance += Window<2>(blocks, r, c).variance() / 4.0;
      if (whole.variance() < 1.4 * variance) ratios_of_row.push_back(variance / whole.variance_within_blocks());
    }
    return ratios_of_row;
  });
  return ratios.size() < kFew ? 1.0 : std::max(median(ratios), 1.0);
}

/// The median over squares of four by four blocks: of the variances of their normals in two directions, the smaller as a part of
/// the larger. Noise tilts blocks in all directions, tubes side by side across the tubes alone.
double evenness_of_tilts(const FlatBlocks& blocks) {
  std::vector<double> ratios;
  for (int row = 0; row + 3 < blocks.rows(); row += 4)
    for (int column = 0; column + 3 < blocks.columns(); column += 4) {
      const Window<4> window(blocks, row, column);
      if (!window.is_measured()) continue;
      const Vec3 upright = window.plane().normal;
      PointMoments normals;
      for (const std::size_t block : window.members()) {
        const Vec3 normal = FittedPlane(blocks.moments(block), blocks.residual(block)).normal;
        normals.add(normal.dot(upright) > 0.0 ? normal : Vec3(-normal));
      }
      const Vec3 variances = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(normals.covariance()).eigenvalues();
      ratios.push_back(variances(1) / variances(2));
    }
  return ratios.empty() ? 0.0 : median(ratios);
}

}  // namespace

void PointMoments::add(const Vec3& p) {
  count += 1.0;
  sum += p;
  xx += p.x() * p.x(), xy += p.x() * p.y(), xz += p.x() * p.z();
  yy += p.y() * p.y(), yz += p.y() * p.z(), zz += p.z() * p.z();
}

PointMoments& PointMoments::operator+=(const PointMoments& other) {
  count += other.count;
  sum += other.sum;
  xx += other.xx, xy += other.xy, xz += other.xz, yy += other.yy, yz += other.yz, zz += other.zz;
  return *this;
}

Eigen::Matrix3d PointMoments::covariance() const {
  Eigen::Matrix3d products;
  products << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return products / count - mean() * mean().transpose();
}

/// The smallest eigenvalue: the first root of the characteristic polynomial, which is concave before it, so that Newton's
/// steps from 0 never pass it. There are some for each dozen points of a scan: a general solver takes a tenth of all time.
double plane_residual(const PointMoments& moments) {
  const Eigen::Matrix3d a = moments.covariance();
  const double linear = a(0, 0) * a(1, 1) - a(0, 1) * a(0, 1) + a(0, 0) * a(2, 2) - a(0, 2) * a(0, 2) +
                        a(1, 1) * a(2, 2) - a(1, 2) * a(1, 2);
  const double trace = a.trace(), determinant = a.determinant();
  double root = 0.0;
  for (int step = 0; step < 20; ++step) {
    const double value = ((root - trace) * root + linear) * root - determinant;
    const double slope = (3.0 * root - 2.0 * trace) * root + linear;
    if (value >= 0.0 || slope <= 0.0) break;
    root -= value / slope;
    if (-value < 1e-9 * root * slope) break;
  }
  return root;
}

/// The normal is the eigenvector of the smallest eigenvalue: square to all rows of what is left without it.
FittedPlane::FittedPlane(const PointMoments& moments, double residual) : center(moments.mean()), mean_square(residual) {
  const Eigen::Matrix3d left = moments.covariance() - mean_square * Eigen::Matrix3d::Identity();
  for (int row = 0; row < 3; ++row) {
    const Vec3 across = left.row(row).cross(left.row((row + 1) % 3));
    if (across.squaredNorm() > normal.squaredNorm()) normal = across;
  }
  normal.normalize();
}

FlatBlocks::FlatBlocks(const SourceView& view, double wider)
    : origin_(view.points[view.points.size() / 2].cast<double>()),
      viewpoint_(view.projection.viewpoint().cast<double>() - origin_),
      angle_(wider * view.spacing.angle) {
  const ViewProjection::Images& images = view.images;
  const auto [u_min, u_max] = std::ranges::minmax(images.u);
  const auto [v_min, v_max] = std::ranges::minmax(images.v);
  constexpr double kMostBlocks = 1 << 22;
  const double block =
      std::max(kPoints * angle_, std::sqrt(double(u_max - u_min) * double(v_max - v_min) / kMostBlocks));
  const auto inverse_block = static_cast<float>(1.0 / block);
  columns_ = static_cast<int>((u_max - u_min) * inverse_block) + 1;
  rows_ = static_cast<int>((v_max - v_min) * inverse_block) + 1;
  moments_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (std::size_t i = 0; i < images.size(); ++i) {
    const int row = static_cast<int>((images.v[i] - v_min) * inverse_block);
    const int column = static_cast<int>((images.u[i] - u_min) * inverse_block);
    moments_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)].add(
        view.points[i].cast<double>() - origin_);
  }
  residuals_.resize(moments_.size(), std::numeric_limits<double>::infinity());
  for_ranges_in_parallel(size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b)
      if (moments_[b].count >= kLeastPoints) residuals_[b] = plane_residual(moments_[b]);
  });
}

double FlatBlocks::roughness() const {
  std::vector<double> variances;
  for (std::size_t b = 0; b < size(); ++b)
    if (has_plane(b)) variances.push_back(residuals_[b] * moments_[b].count / (moments_[b].count - 3.0));
  return variances.empty() ? 0.0 : std::sqrt(median(variances));
}

FlatWindows::FlatWindows(const FlatBlocks& blocks)
    : noise_beyond_blocks_(modeling::noise_beyond_blocks(blocks)), best_(blocks.size()) {
  // A row of windows looks at two rows of blocks: every other one at a time.
  for (const int first : {0, 1})
    tbb::parallel_for(first, blocks.rows() - 1, 2, [&](int row) {
      for (int column = 0; column + 1 < blocks.columns(); ++column) look_at(blocks, row, column);
    });
}

void FlatWindows::look_at(const FlatBlocks& blocks, int row, int column) {
  const Window<2> window(blocks, row, column);
  if (!window.is_measured()) return;
  const double spacing = blocks.spacing(window.members().front());
  const double noise = noise_beyond_blocks_ * window.variance_within_blocks();
  // A parabola x^2 / 2 r over a width w is w^2 / (27 r) off its best line, root mean square: eight spacings of a
  // surface with r = 80 spacings make 0.03 spacings, noise apart. The noise of 64 points varies by a sixth.
  if (window.variance() > 1.4 * noise + 0.0009 * spacing * spacing) return;
  if (window.residual() > 0.25 * spacing * spacing) return;
  const FittedPlane plane = window.plane();
  for (const std::size_t b : window.members())
    if (plane.mean_square < best_[b].mean_square) best_[b] = plane;
}

bool are_tilted_by_noise(const FlatBlocks& blocks, const FlatWindows& windows, double spacing) {
  // Times the variance within blocks; spacings; of noise a third and more, of tubes side by side a twelfth.
  constexpr double kShared = 1.5, kMuch = 0.4, kEven = 0.2;
  const double beyond = windows.noise_beyond_blocks();
  return beyond > kShared && blocks.roughness() * std::sqrt(beyond) > kMuch * spacing &&
         evenness_of_tilts(blocks) > kEven;
}

}  // namespace tubebin::modeling
