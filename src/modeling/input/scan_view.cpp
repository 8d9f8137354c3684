#include "tubebin/modeling/scan_view.hpp"

#include <algorithm>
#include <boost/geometry.hpp>
#include <cmath>
#include <limits>

#include "modeling/input/view_grid.hpp"
#include "modeling/parallel.hpp"
#include "tubebin/core/wide.hpp"

namespace tubebin::modeling {

ViewProjection::ViewProjection(const Pose& world_from_sensor, const cloud::Point& middle_of_points)
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

namespace {

/// Cells in which nothing was measured: anywhere, and within a picture.
constexpr float kEmpty = std::numeric_limits<float>::infinity(), kGap = -kEmpty;

/// Plain arrays that do not overlap, of which vector instructions are made.
TUBEBIN_WIDE void project_arrays(const ViewProjection& projection, const cloud::Point* __restrict points,
                                 std::size_t count, float* __restrict u, float* __restrict v, float* __restrict range) {
  for (std::size_t i = 0; i < count; ++i) {
    const ViewProjection::Image image = projection(points[i]);
    u[i] = image.u, v[i] = image.v, range[i] = image.range;
  }
}

/// Calls visit(image) for every point that is finite.
template <typename Visit>
void for_each_image(const ViewProjection& projection, std::span<const cloud::Point> points, const Visit& visit) {
  // In blocks that stay in the processor's cache: to project twice costs less than to keep the images of a whole cloud.
  constexpr std::size_t kBlock = 512;
  ViewProjection::Images images;
  for (std::size_t first = 0; first < points.size(); first += kBlock) {
    projection.project(points.subspan(first, std::min(kBlock, points.size() - first)), images);
    for (std::size_t i = 0; i < images.size(); ++i)
      if (images.range[i] < std::numeric_limits<float>::infinity()) visit(images[i]);
  }
}

}  // namespace

void ViewProjection::project(std::span<const cloud::Point> points, Images& images) const {
  for (auto* quantity : {&images.u, &images.v, &images.range}) quantity->resize(points.size());
  for_ranges_in_parallel(points.size(), [&](std::size_t first, std::size_t last) {
    project_arrays(*this, &points[first], last - first, &images.u[first], &images.v[first], &images.range[first]);
  });
}

RangeImage::RangeImage(const ViewProjection& projection, std::span<const cloud::Point> points, float cell)
    : projection_(projection) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  float u_min = kInfinity, v_min = kInfinity, u_max = -kInfinity, v_max = -kInfinity;
  for_each_image(projection, points, [&](const ViewProjection::Image& image) {
    u_min = std::min(u_min, image.u), u_max = std::max(u_max, image.u);
    v_min = std::min(v_min, image.v), v_max = std::max(v_max, image.v);
  });
  if (u_max < u_min) return;
  u_min_ = u_min, v_min_ = v_min;
  inverse_cell_ = 1.0f / std::max({cell, static_cast<float>(smallest_cell(u_max - u_min, v_max - v_min)), 1e-9f});
  columns_ = static_cast<int>((u_max - u_min_) * inverse_cell_) + 1;
  rows_ = static_cast<int>((v_max - v_min_) * inverse_cell_) + 1;
  nearest_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), kEmpty);
  for_each_image(projection, points, [&](const ViewProjection::Image& image) {
    const int column = static_cast<int>((image.u - u_min_) * inverse_cell_);
    const int row = static_cast<int>((image.v - v_min_) * inverse_cell_);
    float& nearest = nearest_[cell_at(row, column)];
    nearest = std::min(nearest, image.range);
  });
  is_picture_ = is_picture();
  if (is_picture_) mark_gaps();
}

/// Empty cells that no way over empty cells leads to from the border.
void RangeImage::mark_gaps() {
  for (float& nearest : nearest_)
    if (nearest == kEmpty) nearest = kGap;
  std::vector<std::pair<int, int>> open;  // cells to go on from: row, column
  const auto visit = [&](int row, int column) {
    if (row < 0 || column < 0 || row >= rows_ || column >= columns_) return;
    float& nearest = nearest_[cell_at(row, column)];
    if (nearest != kGap) return;
    nearest = kEmpty;
    open.emplace_back(row, column);
  };
  for (int row = 0; row < rows_; ++row) visit(row, 0), visit(row, columns_ - 1);
  for (int column = 0; column < columns_; ++column) visit(0, column), visit(rows_ - 1, column);
  while (!open.empty()) {
    const auto [row, column] = open.back();
    open.pop_back();
    visit(row - 1, column), visit(row + 1, column), visit(row, column - 1), visit(row, column + 1);
  }
}

/// A picture, of any outline and however it is rotated, is measured nearly everywhere within its convex hull. Where tubes stand
/// alone, most of that is empty.
bool RangeImage::is_picture() const {
  namespace geometry = boost::geometry;
  using Place = geometry::model::d2::point_xy<double>;
  constexpr double kMeasured = 0.75;
  std::size_t measured = 0;
  geometry::model::multi_point<Place> ends_of_rows;
  for (int row = 0; row < rows_; ++row) {
    int first = columns_, last = -1;
    for (int column = 0; column < columns_; ++column) {
      if (nearest_[cell_at(row, column)] == kEmpty) continue;
      first = std::min(first, column), last = column;
      ++measured;
    }
    if (last >= 0)
      for (const int side : {row, row + 1})
        ends_of_rows.emplace_back(first, side), ends_of_rows.emplace_back(last + 1, side);
  }
  geometry::model::polygon<Place> hull;
  geometry::convex_hull(ends_of_rows, hull);
  return static_cast<double>(measured) > kMeasured * geometry::area(hull);
}

RangeImage::Evidence RangeImage::evidence(const cloud::Point& point, float tolerance) const {
  const auto image = projection_(point);
  const float column = (image.u - u_min_) * inverse_cell_;
  const float row = (image.v - v_min_) * inverse_cell_;
  if (!(column >= 0.0f && row >= 0.0f && column < static_cast<float>(columns_) && row < static_cast<float>(rows_)))
    return is_picture_ ? Evidence::outside : Evidence::beyond;
  const float nearest = nearest_[cell_at(static_cast<int>(row), static_cast<int>(column))];
  if (std::isinf(nearest)) return nearest > 0.0f ? Evidence::no_data : Evidence::missing;
  if (nearest < image.range - tolerance) return Evidence::hidden;
  return nearest > image.range + tolerance ? Evidence::empty : Evidence::surface;
}

}  // namespace tubebin::modeling
