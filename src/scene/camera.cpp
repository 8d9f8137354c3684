#include "tubebin/scene/camera.hpp"

#include <cmath>

namespace tubebin::scene {

Camera::Camera(const Scanner& scanner)
    : width_(scanner.width),
      height_(scanner.height),
      focal_length_(scanner.width / 2.0 / std::tan(radians(scanner.horizontal_fov_deg) / 2.0)),
      world_from_scanner_(scanner.world_from_scanner()) {}

Eigen::Matrix3d Camera::intrinsics(const PixelWindow& window) const {
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
  k(0, 0) = k(1, 1) = focal_length_;
  k(0, 2) = width_ / 2.0 - window.x;
  k(1, 2) = height_ / 2.0 - window.y;
  return k;
}

Vec3 Camera::direction_in_world(double x, double y) const {
  const auto axes = world_from_scanner_.linear();
  return axes.col(0) * ((x - width_ / 2.0) / focal_length_) + axes.col(1) * ((y - height_ / 2.0) / focal_length_) +
         axes.col(2);
}

Eigen::Vector2d Camera::project(const Vec3& p_in_scanner) const {
  return {width_ / 2.0 + focal_length_ * p_in_scanner.x() / p_in_scanner.z(),
          height_ / 2.0 + focal_length_ * p_in_scanner.y() / p_in_scanner.z()};
}

}  // namespace tubebin::scene
