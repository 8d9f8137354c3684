/// A scan's view in square blocks, and where their surface is flat.
#pragma once

#include <cmath>
#include <limits>

#include "modeling/input/source_views.hpp"

namespace tubebin::modeling {

/// Sums over points.
struct PointMoments {
  double count = 0.0;
  Vec3 sum = Vec3::Zero();
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;

  void add(const Vec3& p);
  PointMoments& operator+=(const PointMoments& other);
  Vec3 mean() const { return sum / count; }
  Eigen::Matrix3d covariance() const;
};

/// Mean square of the points' distances from their plane of least squares, square metres.
double plane_residual(const PointMoments& moments);

/// The plane of least squares through a set of points.
struct FittedPlane {
  Vec3 center = Vec3::Zero(), normal = Vec3::Zero();
  double mean_square = std::numeric_limits<double>::infinity();  ///< as plane_residual() has it

  FittedPlane() = default;
  explicit FittedPlane(const PointMoments& moments) : FittedPlane(moments, plane_residual(moments)) {}
  /// Where the residual is known.
  FittedPlane(const PointMoments& moments, double residual);
};

/// Blocks of four by four points, where the whole of them is measured; one with six or more has a plane. Positions are from
/// one of the points: sums of far ones would be rounded.
class FlatBlocks {
 public:
  static constexpr double kPoints = 4.0;  ///< in each direction

  /// Of a view that has points. `wider`: than four of its points.
  explicit FlatBlocks(const SourceView& view, double wider = 1.0);

  const Vec3& origin() const { return origin_; }
  std::size_t size() const { return moments_.size(); }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  const PointMoments& moments(std::size_t block) const { return moments_[block]; }
  bool has_plane(std::size_t block) const { return std::isfinite(residuals_[block]); }
  /// Of the block's points, as plane_residual() has it; infinite without a plane.
  double residual(std::size_t block) const { return residuals_[block]; }
  /// The median of the points' standard deviations from their blocks' planes, metres; 0 without blocks.
  double roughness() const;
  /// Metres between neighbouring points of the block, square to the view.
  double spacing(std::size_t block) const { return angle_ * (moments_[block].mean() - viewpoint_).norm(); }

 private:
  Vec3 origin_, viewpoint_;  ///< in the world; from the origin
  double angle_;
  int columns_ = 1, rows_ = 1;
  std::vector<PointMoments> moments_;
  std::vector<double> residuals_;
};

/// The flattest window of two by two blocks that each block is part of: where it is no less flat than its blocks are,
/// the surface is a plane there.
class FlatWindows {
 public:
  explicit FlatWindows(const FlatBlocks& blocks);

  bool is_flat(std::size_t block) const { return std::isfinite(best_[block].mean_square); }
  const FittedPlane& plane(std::size_t block) const { return best_[block]; }
  /// How many times the noise's variance is that within blocks, whose planes follow the noise where neighbours share it
  /// (scanners smooth).
  double noise_beyond_blocks() const { return noise_beyond_blocks_; }

 private:
  void look_at(const FlatBlocks& blocks, int row, int column);

  double noise_beyond_blocks_;
  std::vector<FittedPlane> best_;
};

/// Whether noise that neighbouring points share, as stereo cameras have it, tilts the blocks. `windows`: of the blocks; `spacing`:
/// metres, a quarter of a block's width.
bool are_tilted_by_noise(const FlatBlocks& blocks, const FlatWindows& windows, double spacing);

}  // namespace tubebin::modeling
