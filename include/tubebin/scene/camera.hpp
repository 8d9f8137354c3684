/// The scanner's pinhole camera: square pixels, optical axis through the image's middle, pixel (column, row)
/// has its centre at (column + 0.5, row + 0.5), so the image spans [0, width] x [0, height].
#pragma once

#include "tubebin/scene/scene.hpp"

namespace tubebin::scene {

class Camera {
 public:
  explicit Camera(const Scanner& scanner);

  int width() const { return width_; }
  int height() const { return height_; }
  /// Pixels; half the width divided by the tangent of half the horizontal field of view.
  double focal_length() const { return focal_length_; }
  /// Of the window's pixels, or of all: [f 0 cx; 0 f cy; 0 0 1], pixels.
  Eigen::Matrix3d intrinsics(const PixelWindow& window = {}) const;
  const Pose& world_from_scanner() const { return world_from_scanner_; }

  /// The direction, in world axes, through image position (x, y) in pixels. Its component along the optical
  /// axis is one: the point at scanner + t * direction has depth t.
  Vec3 direction_in_world(double x, double y) const;
  /// As above, through the centre of a pixel.
  Vec3 pixel_direction_in_world(int column, int row) const { return direction_in_world(column + 0.5, row + 0.5); }

  /// Image position in pixels of a point in the scanner's frame; its depth z must not be zero.
  Eigen::Vector2d project(const Vec3& p_in_scanner) const;
  /// Image position in pixels of a point in the world frame; its depth must not be zero.
  Eigen::Vector2d project_from_world(const Vec3& p_in_world) const {
    return project(world_from_scanner_.inverse() * p_in_world);
  }

 private:
  int width_;
  int height_;
  double focal_length_;
  Pose world_from_scanner_;
};

}  // namespace tubebin::scene
