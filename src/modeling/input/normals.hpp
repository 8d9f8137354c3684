/// Surface normals and densities from the neighbours of each point.
#pragma once

#include <span>
#include <vector>

#include "tubebin/modeling/scan_view.hpp"

namespace tubebin::modeling {

/// Unit normals toward the viewpoint by least-squares planes through the neighbours within `radius` metres; zero where
/// a point has fewer than five neighbours or they do not span a plane. Of every stride-th point, beginning with the
/// first, from its neighbours among all points. `viewpoints`: of each point; none: all the projection's.
std::vector<cloud::Point> estimate_normals(const ViewProjection& projection, std::span<const cloud::Point> points,
                                           double radius, std::size_t stride = 1,
                                           std::span<const cloud::Point> viewpoints = {});

/// Points within `radius` metres of each point, itself included.
std::vector<int> count_neighbors(const ViewProjection& projection, std::span<const cloud::Point> points, double radius);

/// Whether each point has fewer than a third of the neighbours that a surface, whose points lie `spacing` metres apart, lets
/// expect.
std::vector<bool> lie_alone(const ViewProjection& projection, std::span<const cloud::Point> points, double spacing);

}  // namespace tubebin::modeling
