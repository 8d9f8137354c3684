/// Flat ends of tubes that are seen from the front, apart from what is seen of the tubes.
#pragma once

#include <span>
#include <vector>

#include "modeling/joining/occlusion.hpp"
#include "tubebin/cloud/cloud.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

struct EndDisc {
  Vec3 center = Vec3::Zero();   ///< metres
  Vec3 outward = Vec3::Zero();  ///< unit
};

/// Discs of the radius, or a quarter of one and more, on planes that go on nowhere. `points`: metres, `spacing` apart where they
/// are seen straight on. They point outward to the viewpoint.
std::vector<EndDisc> find_end_discs(std::span<const Vec3> points, double radius, double spacing, const Vec3& viewpoint);

/// Lengthens paths to discs without a label: of a tube that turns toward the scanner, the side is seen so flatly that nothing
/// follows it, and its end looks like a disc some radii farther on. The tube has to turn by less than a radian on its way there,
/// the scan must not see through where it would be, and no tube gets longer than `lengths` (metres, ascending; empty: any).
/// `labels`: of the cloud's points, 0 or 1 + the tube's place. True if any path changed.
bool reach_end_discs(std::vector<TubeModel>& tubes, const FilteredCloud& cloud, const std::vector<cloud::Label>& labels,
                     const ViewProjection& projection, const OcclusionTest& scan, const std::vector<double>& lengths);

}  // namespace tubebin::modeling
