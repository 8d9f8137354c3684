/// Surface normals from the neighbours of each point.
#pragma once

#include <span>
#include <vector>

#include "modeling/input/neighborhoods.hpp"
#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {

/// Least-squares planes through points' neighbours.
struct TangentPlanes {
  std::vector<cloud::Point> normals;  ///< unit, toward the viewpoint that saw the point; zero where there is no plane
  std::vector<cloud::Point>
      middles;  ///< of the neighbours, metres: a curved surface has the normal there, not at the point
};

/// Normals of a cloud's surface at the points that are asked for: few are needed where points lie close together.
class SurfaceNormals {
 public:
  /// From the neighbours within `radius` metres among all of the cloud's points. The cloud has to outlive it, unchanged.
  SurfaceNormals(const FilteredCloud& cloud, const ViewProjection& projection, double radius);

  double radius() const { return radius_; }
  /// Of the points at `indices`; none where a point has fewer than five neighbours or they do not span a plane. Fastest in the
  /// order of the scanner's view.
  TangentPlanes planes_at(std::span<const std::uint32_t> indices) const;
  std::vector<cloud::Point> at(std::span<const std::uint32_t> indices) const { return planes_at(indices).normals; }
  /// Indices of the points within `reach` metres of the point, itself among them.
  std::vector<std::uint32_t> around(std::uint32_t point, double reach) const;

 private:
  const FilteredCloud& cloud_;
  ViewProjection projection_;
  double radius_;
  Neighborhoods neighborhoods_;
};

/// Estimates the normals of all of the cloud's points. `radius`: of the tubes, metres; 0 where it is not known.
void add_normals(FilteredCloud& cloud, const ViewProjection& projection, double radius);

/// Every so many of the cloud's points, that they lie about `apart` metres from each other, or all where they already do,
/// with normals.
FilteredCloud thinned(const FilteredCloud& cloud, double apart, const SurfaceNormals& normals);

}  // namespace tubebin::modeling
