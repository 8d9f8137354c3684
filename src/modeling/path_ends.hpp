/// Both ends of the tubes' paths, and the points about them.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

struct PathEnd {
  Vec3 tip, outward;  ///< outward: unit, over the last radius of the path
};

/// Of the end that the nodes, two or more, lead to.
PathEnd last_end(const std::vector<Vec3>& nodes, double radius);

/// Indices of the points that belong to no tube.
Segment points_without_label(std::span<const cloud::Label> labels);

/// Those of the points at the indices that are no farther from an end of a tube than `reach`, metres, says of the tube.
Segment about_ends(const std::vector<TubeModel>& tubes, std::span<const cloud::Point> points, const Segment& indices,
                   const std::function<double(const TubeModel&)>& reach);

/// Those closer than `distance` metres to a place.
Segment near(const Vec3& place, double distance, std::span<const cloud::Point> points, const Segment& indices);

}  // namespace tubebin::modeling
