#include "tubebin/modeling/scan_view.hpp"

#include <cmath>
#include <limits>

namespace tubebin {

ViewProjection::ViewProjection(const Pose& world_from_sensor, const Point& middle_of_points)
    : viewpoint_(world_from_sensor.translation().cast<float>()) {
  const Vec3 to_middle = (middle_of_points.cast<double>() - world_from_sensor.translation());
  Vec3 z = world_from_sensor.linear().col(2);
  if (z.dot(to_middle) < 0.5 * to_middle.norm()) z = to_middle;
  z.normalize();
  Vec3 x = world_from_sensor.linear().col(0);
  if (std::abs(x.dot(z)) > 0.9) x = world_from_sensor.linear().col(1);
  x = (x - x.dot(z) * z).normalized();
  axes_from_world_.row(0) = x.cast<float>();
  axes_from_world_.row(1) = z.cross(x).cast<float>();
  axes_from_world_.row(2) = z.cast<float>();
}

RangeImage::RangeImage(const ViewProjection& projection, std::span<const Point> points,
                       std::span<const std::uint32_t> selected, float cell)
    : projection_(projection), inverse_cell_(1.0f / cell) {
  std::vector<ViewProjection::Image> images;
  images.reserve(selected.size());
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  float u_max = -kInfinity, v_max = -kInfinity;
  u_min_ = v_min_ = kInfinity;
  for (const std::uint32_t index : selected) {
    const auto image = images.emplace_back(projection(points[index]));
    u_min_ = std::min(u_min_, image.u);
    v_min_ = std::min(v_min_, image.v);
    u_max = std::max(u_max, image.u);
    v_max = std::max(v_max, image.v);
  }
  if (images.empty()) return;
  columns_ = static_cast<int>((u_max - u_min_) * inverse_cell_) + 1;
  rows_ = static_cast<int>((v_max - v_min_) * inverse_cell_) + 1;
  nearest_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), kInfinity);
  for (const auto& image : images) {
    const int column = static_cast<int>((image.u - u_min_) * inverse_cell_);
    const int row = static_cast<int>((image.v - v_min_) * inverse_cell_);
    float& nearest = nearest_[static_cast<std::size_t>(row * columns_ + column)];
    nearest = std::min(nearest, image.range);
  }
}

RangeImage::Evidence RangeImage::evidence(const Point& point, float tolerance) const {
  const auto image = projection_(point);
  const float column = (image.u - u_min_) * inverse_cell_;
  const float row = (image.v - v_min_) * inverse_cell_;
  if (!(column >= 0.0f && row >= 0.0f && column < static_cast<float>(columns_) && row < static_cast<float>(rows_)))
    return Evidence::empty;
  const float nearest = nearest_[static_cast<std::size_t>(static_cast<int>(row) * columns_ + static_cast<int>(column))];
  if (nearest < image.range - tolerance) return Evidence::hidden;
  return nearest > image.range + tolerance ? Evidence::empty : Evidence::surface;
}

}  // namespace tubebin
