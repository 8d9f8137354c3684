/// Neighbours in space of a cloud's points, found in the scanner's view.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "modeling/input/view_grid.hpp"

namespace tubebin::modeling {

/// Sums over neighbours q of a point p, of d = q - p.
struct Moments {
  float count = 0.0f, x = 0.0f, y = 0.0f, z = 0.0f;
  float xx = 0.0f, xy = 0.0f, xz = 0.0f, yy = 0.0f, yz = 0.0f, zz = 0.0f;

  Vec3 mean() const { return Vec3(x, y, z) / double(count); }
  Eigen::Matrix3d covariance() const;
};

/// Coordinates, one array each.
struct PointArrays {
  std::vector<float> x, y, z;
};

class Neighborhoods {
 public:
  /// Of points that have to outlive it, for searches within about `radius` metres.
  Neighborhoods(const ViewProjection& projection, std::span<const cloud::Point> points, double radius);

  /// Indices of the points, in an order in which one point's neighbours are mostly the next one's.
  const std::vector<std::uint32_t>& order() const { return grid_.order(); }

  /// A part of the view, and the points in it. The next point is mostly in the same one.
  class Window {
   public:
    /// Of what lies within `radius` metres of a point.
    Window(const Neighborhoods& all, double radius) : all_(all), radius_(static_cast<float>(radius)) {}

    /// Of the points within the radius, `wider` times, of point i, in the part of the view that the radius covers.
    Moments moments_around(std::size_t i, float wider = 1.0f);
    /// The same about a place in the direction of point i.
    Moments moments_about(const cloud::Point& place, std::size_t i, float wider = 1.0f);
    /// Indices of the points within the radius of point i, itself among them.
    std::vector<std::uint32_t> points_around(std::size_t i);

   private:
    struct Place {
      int row = 0, column = 0, reach = -1;
      bool operator==(const Place&) const = default;
    };

    void look_at(std::size_t i);

    const Neighborhoods& all_;
    float radius_;
    Place place_;  ///< of the point last looked at
    /// Of the points in it: positions [first, last) in order().
    std::vector<std::pair<std::uint32_t, std::uint32_t>> runs_;
  };

 private:
  std::span<const cloud::Point> points_;
  float cell_;
  ViewGrid grid_;
  PointArrays sorted_;  ///< in grid order, so that a row of cells is one run of memory
};

/// Points within `radius` metres of each point, itself included.
std::vector<int> count_neighbors(const ViewProjection& projection, std::span<const cloud::Point> points, double radius);

/// Whether each point has fewer than a third of the neighbours that a surface, whose points lie `spacing` metres apart, lets
/// expect.
std::vector<bool> lie_alone(const ViewProjection& projection, std::span<const cloud::Point> points, double spacing);

}  // namespace tubebin::modeling
