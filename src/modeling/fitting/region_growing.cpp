#include "tubebin/modeling/region_growing.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "modeling/fitting/nearest_neighbors.hpp"

namespace tubebin::modeling {
namespace {

/// The points that have a normal, and the neighbours of each among them.
struct Surface {
  Segment source;  ///< indices in the cloud
  std::vector<cloud::Point> points, normals;
  std::vector<std::vector<std::uint32_t>> neighbors;

  Surface(const FilteredCloud& cloud, std::size_t neighbor_count) {
    for (std::uint32_t i = 0; i < cloud.points.size(); ++i) {
      if (cloud.normals[i].isZero()) continue;
      source.push_back(i);
      points.push_back(cloud.points[i]);
      normals.push_back(cloud.normals[i]);
    }
    const NearestNeighbors nearest(points);
    for (const cloud::Point& p : points) neighbors.push_back(nearest.find(p, neighbor_count));
  }
};

/// Every point, in the order in which regions begin: PCL sorts points by curvature, and this is where std::sort leaves
/// those whose curvature it does not know.
std::vector<std::uint32_t> order_of_seeds(std::size_t count) {
  std::vector<std::uint32_t> seeds(count);
  std::iota(seeds.begin(), seeds.end(), 0U);
  std::sort(seeds.begin(), seeds.end(), [](std::uint32_t, std::uint32_t) { return false; });
  return seeds;
}

/// All that can be reached from the seed, from neighbour to neighbour, and no region has; it has it from now on.
Segment grow_region(const Surface& surface, std::uint32_t seed, float cosine_min, std::vector<bool>& is_taken) {
  Segment region = {seed};
  is_taken[seed] = true;
  for (std::size_t k = 0; k < region.size(); ++k) {
    const std::uint32_t from = region[k];
    for (const std::uint32_t to : surface.neighbors[from]) {
      if (is_taken[to] || std::abs(surface.normals[to].dot(surface.normals[from])) < cosine_min) continue;
      is_taken[to] = true;
      region.push_back(to);
    }
  }
  return region;
}

}  // namespace

void describe(Fields& fields, RegionGrowingOptions& options) {
  fields.integer("neighbors", options.neighbors, {3, 1000}, "", "of a point, looked at for growing");
  fields.number(
      "smoothness_deg", options.smoothness_deg, {0.1, 90.0}, "degrees",
      "largest angle between the normals of neighbours in one region, and of a cylinder's points with its side's");
  fields.removed("curvature_max", "never had an effect: regions grow by normals alone");
  fields.integer("region_size_min", options.region_size_min, {3, 1000000}, "points",
                 "smaller regions and cylinders are left out");
  fields.integer("ransac_iterations", options.ransac_iterations, {1, 1000000}, "", "of the search for one cylinder");
  fields.number("inlier_distance", options.inlier_distance, {0.001, 1.0}, "radii",
                "how far a cylinder's points may be off its surface");
}

std::vector<Segment> grow_regions(const FilteredCloud& cloud, const RegionGrowingOptions& options) {
  const Surface surface(cloud, static_cast<std::size_t>(options.neighbors));
  if (surface.points.size() <= static_cast<std::size_t>(options.neighbors)) return {};
  const auto cosine_min = static_cast<float>(std::cos(radians(options.smoothness_deg)));
  std::vector<bool> is_taken(surface.points.size(), false);
  std::vector<Segment> segments;
  for (const std::uint32_t seed : order_of_seeds(surface.points.size())) {
    if (is_taken[seed]) continue;
    Segment segment = grow_region(surface, seed, cosine_min, is_taken);
    if (static_cast<int>(segment.size()) < options.region_size_min) continue;
    for (std::uint32_t& point : segment) point = surface.source[point];
    std::ranges::sort(segment);
    segments.push_back(std::move(segment));
  }
  return segments;
}

}  // namespace tubebin::modeling
