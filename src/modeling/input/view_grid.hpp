/// Neighbourhoods of a scanned cloud: what is near in space is near in the scanner's view, so a grid over the view
/// finds neighbours in constant time, for organized and unorganized clouds alike.
#pragma once

#include <span>
#include <vector>

#include "tubebin/modeling/scan_view.hpp"

namespace tubebin::modeling {

/// The smallest cell that keeps a grid over such an extent within its memory, however far apart its points lie.
double smallest_cell(double width, double height);

class ViewGrid {
 public:
  /// `cell`: size of the cells in the plane of the projection.
  ViewGrid(const ViewProjection& projection, std::span<const cloud::Point> points, float cell)
      : ViewGrid(projection.images(points), points, cell) {}
  /// Of points that are projected already, to `images`.
  ViewGrid(ViewProjection::Images images, std::span<const cloud::Point> points, float cell);

  /// Indices of the points, cell by cell, within a cell by their coordinates: an order that the positions determine.
  const std::vector<std::uint32_t>& order() const { return order_; }
  ViewProjection::Image image(std::size_t point) const { return images_[point]; }
  int column(std::size_t point) const { return static_cast<int>(cells_[point] % columns_); }
  int row(std::size_t point) const { return static_cast<int>(cells_[point] / columns_); }

  /// Positions [first, last) in order() of the cells (row, first_column) to (row, last_column), clipped to the grid.
  std::pair<std::uint32_t, std::uint32_t> range(int row, int first_column, int last_column) const;

 private:
  std::uint32_t columns_ = 1, rows_ = 1;
  ViewProjection::Images images_;
  std::vector<std::uint32_t> cells_;   ///< of each point
  std::vector<std::uint32_t> starts_;  ///< of each cell in order_
  std::vector<std::uint32_t> order_;
};

/// Root of the area that one point stands for; 0 where there are no points.
struct PointSpacing {
  double angle = 0.0;   ///< in the plane of the projection, radians
  double metres = 0.0;  ///< at the points' median range
};

/// From how many points the cells of a grid hold.
PointSpacing estimate_spacing(const ViewProjection::Images& images);

}  // namespace tubebin::modeling
