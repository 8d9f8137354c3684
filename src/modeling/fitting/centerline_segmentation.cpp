#include "modeling/fitting/centerline_segmentation.hpp"

#include <algorithm>
#include <cmath>

#include "modeling/fitting/vote_voxels.hpp"

namespace tubebin::modeling {

std::vector<Segment> segment_by_votes(const FilteredCloud& cloud, double radius) {
  std::vector<cloud::Point> votes;
  Segment voters;
  votes.reserve(cloud.points.size());
  voters.reserve(cloud.points.size());
  for (std::uint32_t i = 0; i < cloud.points.size(); ++i) {
    if (cloud.normals[i].isZero()) continue;
    votes.push_back(cloud.points[i] - static_cast<float>(radius) * cloud.normals[i]);
    voters.push_back(i);
  }
  // Voxels of r / 3 hold the scatter of the votes (a normal that is 15 degrees off votes r / 4 beside the line). Links
  // of r / 2 stay clear of the nearest that two centrelines can come, r, by as much again for the scatter.
  const double voxel = radius / 3.0;
  const double link = radius / 2.0;
  // A fully visible tube gives a voxel this many votes; what has a twentieth of that is either chance or a sliver
  // narrower than the scatter.
  const double full = points_of_visible_stretch(radius, voxel, cloud.spacing);
  const auto least = static_cast<std::size_t>(std::max(std::ceil(full / 20.0), 2.0));
  const VoteVoxels voxels(votes, voxel, least);
  const auto component = connected_components(voxels.size(), voxels.links(link));

  std::vector<Segment> segments;
  for (std::size_t k = 0; k < voters.size(); ++k) {
    const std::uint32_t v = voxels.voxel_of(k);
    if (v == VoteVoxels::kNone) continue;
    if (component[v] >= segments.size()) segments.resize(component[v] + 1);
    segments[component[v]].push_back(voters[k]);
  }
  // A cylinder of known radius has four unknowns: fewer points are near one wherever they lie, and bits of tubes that
  // lead anywhere only tempt the joining.
  std::erase_if(segments, [](const Segment& segment) { return segment.size() < 4; });
  return segments;
}

}  // namespace tubebin::modeling
