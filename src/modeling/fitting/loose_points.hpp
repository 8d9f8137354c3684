/// The points of a cloud that no segment holds.
#pragma once

#include <span>
#include <vector>

#include "modeling/fitting/surface_fitting.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

class LoosePoints {
 public:
  LoosePoints() = default;
  /// `reach`: metres, of all queries.
  LoosePoints(const FilteredCloud& cloud, const std::vector<Segment>& segments, double reach);

  /// Calls visit(point) for those within the reach of a place, and a few more.
  template <typename Visit>
  void for_each_about(const Vec3& place, const Visit& visit) const {
    for (const double beside : {-1.0, 0.0, 1.0})
      for (const SurfacePoint& point : part_about(strip_of(place) + beside, place)) visit(point);
  }

 private:
  /// A whole number, as a double: that of an outlier far away is no int.
  double strip_of(const Vec3& position) const;
  /// Of a strip, what lies as far along it as the place, to the reach.
  std::span<const SurfacePoint> part_about(double strip, const Vec3& place) const;

  double reach_ = 0.0;
  std::vector<SurfacePoint> points_;  ///< by strips of y as wide as the reach, in order of x in each
};

}  // namespace tubebin::modeling
