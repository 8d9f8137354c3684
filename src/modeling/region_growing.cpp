#include "tubebin/modeling/region_growing.hpp"

#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/region_growing.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <algorithm>

namespace tubebin {
namespace {

using PclPoints = pcl::PointCloud<pcl::PointXYZ>;
using PclNormals = pcl::PointCloud<pcl::Normal>;

struct PclCloud {
  PclPoints::Ptr points{new PclPoints};
  PclNormals::Ptr normals{new PclNormals};

  void add(const Point& p, const Point& n) {
    points->push_back(pcl::PointXYZ(p.x(), p.y(), p.z()));
    normals->push_back(pcl::Normal(n.x(), n.y(), n.z()));
  }
};

/// One cylinder: from the first to the last of its points along its axis.
TubePiece make_piece(const FilteredCloud& cloud, const Vec3& on_axis, const Vec3& axis, double radius,
                     const Segment& inliers) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const std::uint32_t i : inliers) {
    const double along = (cloud.points[i].cast<double>() - on_axis).dot(axis);
    low = std::min(low, along);
    high = std::max(high, along);
  }
  return {.nodes = {on_axis + low * axis, on_axis + high * axis}, .radius = radius, .points = inliers};
}

/// The most populated cylinder that RANSAC finds among the points, its inliers removed from them.
std::optional<TubePiece> take_cylinder(const FilteredCloud& cloud, Segment& remaining, double radius,
                                       const RegionGrowingOptions& options) {
  PclCloud pcl_cloud;
  for (const std::uint32_t i : remaining) pcl_cloud.add(cloud.points[i], cloud.normals[i]);
  pcl::SACSegmentationFromNormals<pcl::PointXYZ, pcl::Normal> sac;
  sac.setModelType(pcl::SACMODEL_CYLINDER);
  sac.setMethodType(pcl::SAC_RANSAC);
  sac.setNormalDistanceWeight(0.05);
  sac.setMaxIterations(options.ransac_iterations);
  sac.setDistanceThreshold(options.inlier_distance * radius);
  sac.setRadiusLimits(0.8 * radius, 1.2 * radius);
  // PCL's refinement of a cylinder can leave the radius limits, and even turn negative: the sample's stays.
  sac.setOptimizeCoefficients(false);
  sac.setInputCloud(pcl_cloud.points);
  sac.setInputNormals(pcl_cloud.normals);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients c;
  sac.segment(inliers, c);
  if (static_cast<int>(inliers.indices.size()) < options.region_size_min || c.values.size() != 7) return std::nullopt;
  Segment taken, left;
  std::size_t next = 0;
  for (std::size_t k = 0; k < remaining.size(); ++k) {
    const bool is_inlier = next < inliers.indices.size() && inliers.indices[next] == static_cast<int>(k);
    (is_inlier ? taken : left).push_back(remaining[k]);
    if (is_inlier) ++next;
  }
  remaining = std::move(left);
  const Vec3 axis = Vec3(double(c.values[3]), double(c.values[4]), double(c.values[5])).normalized();
  return make_piece(cloud, Vec3(double(c.values[0]), double(c.values[1]), double(c.values[2])), axis, radius, taken);
}

}  // namespace

void describe(Fields& fields, RegionGrowingOptions& options) {
  fields.integer("neighbors", options.neighbors, {3, 1000}, "", "of a point, looked at for growing");
  fields.number("smoothness_deg", options.smoothness_deg, {0.1, 90.0}, "degrees",
                "largest angle between the normals of neighbours in one region");
  fields.number("curvature_max", options.curvature_max, {0.0, 1.0}, "",
                "surface variation up to which a region grows on from a point");
  fields.integer("region_size_min", options.region_size_min, {3, 1000000}, "points",
                 "smaller regions and cylinders are left out");
  fields.integer("ransac_iterations", options.ransac_iterations, {1, 1000000}, "", "of the search for one cylinder");
  fields.number("inlier_distance", options.inlier_distance, {0.001, 1.0}, "radii",
                "how far a cylinder's points may be off its surface");
}

std::vector<Segment> grow_regions(const FilteredCloud& cloud, const RegionGrowingOptions& options) {
  PclCloud pcl_cloud;
  Segment dense;  // RegionGrowing with indices into a larger cloud is unreliable: it gets a cloud of its own
  for (std::uint32_t i = 0; i < cloud.points.size(); ++i) {
    if (cloud.normals[i].isZero()) continue;
    dense.push_back(i);
    pcl_cloud.add(cloud.points[i], cloud.normals[i]);
  }
  if (static_cast<int>(dense.size()) <= options.neighbors) return {};
  pcl::RegionGrowing<pcl::PointXYZ, pcl::Normal> growing;
  growing.setMinClusterSize(options.region_size_min);
  growing.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
  growing.setNumberOfNeighbours(static_cast<unsigned>(options.neighbors));
  growing.setInputCloud(pcl_cloud.points);
  growing.setInputNormals(pcl_cloud.normals);
  growing.setSmoothnessThreshold(static_cast<float>(radians(options.smoothness_deg)));
  growing.setCurvatureThreshold(static_cast<float>(options.curvature_max));
  std::vector<pcl::PointIndices> clusters;
  growing.extract(clusters);
  std::vector<Segment> segments;
  for (const auto& cluster : clusters) {
    Segment segment;
    for (const int k : cluster.indices) segment.push_back(dense[static_cast<std::size_t>(k)]);
    std::sort(segment.begin(), segment.end());
    segments.push_back(std::move(segment));
  }
  return segments;
}

std::vector<TubePiece> fit_cylinders(const FilteredCloud& cloud, const Segment& segment, double radius,
                                     const RegionGrowingOptions& options) {
  std::vector<TubePiece> pieces;
  Segment remaining = segment;
  while (static_cast<int>(remaining.size()) >= options.region_size_min) {
    auto piece = take_cylinder(cloud, remaining, radius, options);
    if (!piece) break;
    if (piece->length() > radius / 4.0) pieces.push_back(std::move(*piece));
  }
  return pieces;
}

}  // namespace tubebin
