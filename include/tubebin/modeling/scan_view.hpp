/// The scene as the scanner saw it: directions from the viewpoint as points of a plane, and the nearest range in each.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::modeling {

/// Stereographic projection of the directions from a viewpoint: conformal, and defined for every direction but the
/// one straight back, so that neighbours in space are neighbours in the plane whatever the field of view. Near the
/// view axis, one unit of the plane is one radian.
class ViewProjection {
 public:
  struct Image {
    float u, v;   ///< position in the plane
    float range;  ///< distance from the viewpoint, metres
  };

  /// Of many points, one array a quantity.
  struct Images {
    std::vector<float> u, v, range;

    std::size_t size() const { return u.size(); }
    Image operator[](std::size_t point) const { return {u[point], v[point], range[point]}; }
  };

  /// The view axis is the sensor's z axis, or, where the points do not lie in front of it (a pose that states a
  /// position alone), the direction to the middle of the points.
  ViewProjection(const Pose& world_from_sensor, const cloud::Point& middle_of_points);

  Image operator()(const cloud::Point& point_in_world) const {
    const cloud::Point offset = point_in_world - viewpoint_;
    return image_of(offset.x(), offset.y(), offset.z());
  }
  Images images(std::span<const cloud::Point> points) const {
    Images images;
    project(points, images);
    return images;
  }
  /// As images(), into memory that is there.
  void project(std::span<const cloud::Point> points, Images& images) const;
  const cloud::Point& viewpoint() const { return viewpoint_; }

 private:
  /// Of an offset from the viewpoint, in world axes.
  Image image_of(float x, float y, float z) const {
    const auto& axes = axes_from_world_;
    const float right = axes(0, 0) * x + axes(0, 1) * y + axes(0, 2) * z;
    const float down = axes(1, 0) * x + axes(1, 1) * y + axes(1, 2) * z;
    const float ahead = axes(2, 0) * x + axes(2, 1) * y + axes(2, 2) * z;
    const float range = std::sqrt(right * right + down * down + ahead * ahead);
    const float scale = 2.0f / std::max(range + ahead, 1e-6f * range + 1e-12f);
    return {right * scale, down * scale, range};
  }

  cloud::Point viewpoint_;
  Eigen::Matrix3f axes_from_world_;
};

/// Where the scanner stood that saw point k: the point's one of `viewpoints`, or, without any, the projection's.
inline const cloud::Point& viewpoint_of(std::size_t k, std::span<const cloud::Point> viewpoints,
                                        const ViewProjection& projection) {
  return viewpoints.empty() ? projection.viewpoint() : viewpoints[k];
}

/// Nearest measured range in every cell of the view.
class RangeImage {
 public:
  /// `cell` is the cells' size in the plane of the projection, larger where that would take too much memory. Points that are
  /// not finite are left out.
  RangeImage(const ViewProjection& projection, std::span<const cloud::Point> points, float cell);

  /// In ascending order of what counts where several scanners look: empty is what one of them saw through, hidden what is
  /// hidden from all.
  enum class Evidence {
    beyond,   ///< the scan does not reach there, and is no picture: nothing was measured
    outside,  ///< the scan is a picture that does not reach there
    missing,  ///< the scanner measured nothing there and all around it: it failed
    hidden,   ///< the scanner measured something nearer: what is at the point cannot be seen
    no_data,  ///< the scanner measured nothing in this direction: nothing is in its reach, or it was left out
    surface,  ///< the scanner measured a surface at the point, within the tolerance
    empty     ///< the scanner saw through the point: nothing is there
  };
  /// What the scan says about a surface at `point`.
  Evidence evidence(const cloud::Point& point, float tolerance) const;

 private:
  std::size_t cell_at(int row, int column) const { return static_cast<std::size_t>(row * columns_ + column); }
  bool is_picture() const;
  void mark_gaps();

  ViewProjection projection_;
  float inverse_cell_ = 1.0f;
  float u_min_ = 0.0f, v_min_ = 0.0f;
  int columns_ = 0, rows_ = 0;
  std::vector<float> nearest_;  ///< infinity where nothing was measured; negative infinity in gaps of a picture
  bool is_picture_ = false;     ///< measured nearly everywhere within its outline, and so cut off there
};

}  // namespace tubebin::modeling
