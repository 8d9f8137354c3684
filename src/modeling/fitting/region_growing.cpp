#include "tubebin/modeling/region_growing.hpp"

#include <pcl/console/print.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/region_growing.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "modeling/fitting/surface_fitting.hpp"

namespace tubebin::modeling {
namespace {

using PclPoints = pcl::PointCloud<pcl::PointXYZ>;
using PclNormals = pcl::PointCloud<pcl::Normal>;

struct PclCloud {
  PclPoints::Ptr points{new PclPoints};
  PclNormals::Ptr normals{new PclNormals};

  void add(const cloud::Point& p, const cloud::Point& n) {
    points->push_back(pcl::PointXYZ(p.x(), p.y(), p.z()));
    normals->push_back(pcl::Normal(n.x(), n.y(), n.z()));
  }
};

/// A cylinder without ends, and the points that RANSAC found on it.
struct CylinderAxis {
  Vec3 point, direction;
  Segment inliers;

  double low = -std::numeric_limits<double>::infinity(), high = -low;  ///< along the axis, metres

  double distance(const Vec3& p) const { return (p - point).cross(direction).norm(); }
  /// From the surface, and from the stretch that the cylinder covers where the point is beyond its ends.
  double distance_off(const Vec3& p, double radius) const {
    const double along = (p - point).dot(direction);
    return std::abs(distance(p) - radius) + std::max({low - along, along - high, 0.0});
  }
};

/// The cylinder on which RANSAC finds most of a sample of the points.
std::optional<CylinderAxis> search_cylinder(const FilteredCloud& cloud, const Segment& remaining, double radius,
                                            const RegionGrowingOptions& options) {
  // RANSAC's time goes into counting inliers, and some hundred points tell a good cylinder from a bad one.
  constexpr std::size_t kSample = 400;
  PclCloud sample;
  for (std::size_t k = 0; k < remaining.size(); k += remaining.size() / kSample + 1)
    sample.add(cloud.points[remaining[k]], cloud.normals[remaining[k]]);
  // What is left of a segment often holds no cylinder: that is no error to print.
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  pcl::SACSegmentationFromNormals<pcl::PointXYZ, pcl::Normal> sac;
  sac.setModelType(pcl::SACMODEL_CYLINDER);
  sac.setMethodType(pcl::SAC_RANSAC);
  sac.setNormalDistanceWeight(0.05);
  sac.setMaxIterations(options.ransac_iterations);
  sac.setDistanceThreshold(options.inlier_distance * radius);
  sac.setRadiusLimits(0.8 * radius, 1.2 * radius);
  // PCL's refinement of a cylinder can leave the radius limits, and even turn negative: ours knows the radius.
  sac.setOptimizeCoefficients(false);
  sac.setInputCloud(sample.points);
  sac.setInputNormals(sample.normals);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients c;
  sac.segment(inliers, c);
  if (inliers.indices.size() < 5 || c.values.size() != 7) return std::nullopt;
  return CylinderAxis{.point = Vec3(double(c.values[0]), double(c.values[1]), double(c.values[2])),
                      .direction = Vec3(double(c.values[3]), double(c.values[4]), double(c.values[5])).normalized(),
                      .inliers = {}};
}

/// Sorts the points into the axis's inliers and the rest.
Segment take_inliers(const FilteredCloud& cloud, const Segment& points, CylinderAxis& axis, double radius,
                     const RegionGrowingOptions& options) {
  const double band = options.inlier_distance * radius, leaning = std::sin(radians(options.smoothness_deg));
  Segment left, inliers;
  for (const std::uint32_t i : points) {
    // Where the tube bends away, its surface crosses the cylinder's.
    const bool is_inlier = std::abs(axis.distance(cloud.points[i].cast<double>()) - radius) < band &&
                           std::abs(cloud.normals[i].cast<double>().dot(axis.direction)) < leaning;
    (is_inlier ? inliers : left).push_back(i);
  }
  axis.inliers = std::move(inliers);
  return left;
}

/// Least squares with the known radius on the inliers.
void refine(const FilteredCloud& cloud, CylinderAxis& axis, double radius) {
  double low = 0.0, high = 0.0;
  std::vector<SurfacePoint> surface;
  for (std::size_t k = 0; k < axis.inliers.size(); k += axis.inliers.size() / 500 + 1) {
    const Vec3 p = cloud.points[axis.inliers[k]].cast<double>();
    surface.push_back({p, cloud.normals[axis.inliers[k]].cast<double>()});
    const double along = (p - axis.point).dot(axis.direction);
    low = surface.size() == 1 ? along : std::min(low, along);
    high = surface.size() == 1 ? along : std::max(high, along);
  }
  if (high - low < radius / 2.0) return;
  std::vector<Vec3> nodes = {axis.point + low * axis.direction, axis.point + high * axis.direction};
  fit_surface(nodes, surface, radius);
  axis.point = nodes[0];
  axis.direction = (nodes[1] - nodes[0]).normalized();
}

/// The most populated cylinder that is found among the points, its inliers removed from them.
std::optional<CylinderAxis> take_cylinder(const FilteredCloud& cloud, Segment& remaining, double radius,
                                          const RegionGrowingOptions& options) {
  auto axis = search_cylinder(cloud, remaining, radius, options);
  if (!axis) return std::nullopt;
  take_inliers(cloud, remaining, *axis, radius, options);
  refine(cloud, *axis, radius);
  remaining = take_inliers(cloud, remaining, *axis, radius, options);
  if (static_cast<int>(axis->inliers.size()) < options.region_size_min) return std::nullopt;
  return axis;
}

/// Gives every point to the cylinder whose surface it is nearest to.
void reassign_inliers(const FilteredCloud& cloud, std::vector<CylinderAxis>& axes, double radius) {
  Segment all;
  for (CylinderAxis& axis : axes) {
    all.insert(all.end(), axis.inliers.begin(), axis.inliers.end());
    axis.inliers.clear();
  }
  for (const std::uint32_t i : all) {
    const Vec3 p = cloud.points[i].cast<double>();
    const auto off = [&](const CylinderAxis& axis) { return axis.distance_off(p, radius); };
    std::min_element(axes.begin(), axes.end(), [&](const CylinderAxis& a, const CylinderAxis& b) {
      return off(a) < off(b);
    })->inliers.push_back(i);
  }
}

void find_extents(const FilteredCloud& cloud, std::vector<CylinderAxis>& axes) {
  for (CylinderAxis& axis : axes) {
    axis.low = std::numeric_limits<double>::infinity();
    axis.high = -axis.low;
    for (const std::uint32_t i : axis.inliers) {
      const double along = (cloud.points[i].cast<double>() - axis.point).dot(axis.direction);
      axis.low = std::min(axis.low, along);
      axis.high = std::max(axis.high, along);
    }
  }
}

/// The first cylinders of a segment cut across its bends, and the later ones make do with the strips that were left:
/// inliers and axes are found in turns, as k-means does, and cylinders that others can do without go.
void refine_jointly(const FilteredCloud& cloud, std::vector<CylinderAxis>& axes, double radius,
                    const RegionGrowingOptions& options) {
  constexpr int kRounds = 4;
  const double band = options.inlier_distance * radius;
  for (int round = 0; round < kRounds && !axes.empty(); ++round) {
    find_extents(cloud, axes);
    reassign_inliers(cloud, axes, radius);
    for (CylinderAxis& axis : axes) refine(cloud, axis, radius);
    find_extents(cloud, axes);
    const auto fewest = std::min_element(axes.begin(), axes.end(), [](const CylinderAxis& a, const CylinderAxis& b) {
      return a.inliers.size() < b.inliers.size();
    });
    const auto is_spared = [&](std::uint32_t i) {
      const Vec3 p = cloud.points[i].cast<double>();
      return std::any_of(axes.begin(), axes.end(), [&](const CylinderAxis& axis) {
        return &axis != &*fewest && axis.distance_off(p, radius) < band;
      });
    };
    const auto spared = std::count_if(fewest->inliers.begin(), fewest->inliers.end(), is_spared);
    if (axes.size() < 2 || 10 * static_cast<std::size_t>(spared) < 7 * fewest->inliers.size()) continue;
    const Segment freed = std::move(fewest->inliers);
    axes.erase(fewest);
    axes.front().inliers.insert(axes.front().inliers.end(), freed.begin(), freed.end());
    round = -1;  // with one cylinder less, all over again
  }
  if (axes.empty()) return;
  find_extents(cloud, axes);
  reassign_inliers(cloud, axes, radius);
}

/// From the first to the last of its points along the axis, a hundredth of them cut off at either end as strays.
TubePiece make_piece(const FilteredCloud& cloud, const CylinderAxis& axis, double radius) {
  std::vector<double> along;
  for (const std::uint32_t i : axis.inliers)
    along.push_back((cloud.points[i].cast<double>() - axis.point).dot(axis.direction));
  std::sort(along.begin(), along.end());
  const double low = along[along.size() / 100], high = along[along.size() - 1 - along.size() / 100];
  return {.nodes = {axis.point + low * axis.direction, axis.point + high * axis.direction},
          .radius = radius,
          .points = axis.inliers};
}

}  // namespace

void describe(Fields& fields, RegionGrowingOptions& options) {
  fields.integer("neighbors", options.neighbors, {3, 1000}, "", "of a point, looked at for growing");
  fields.number(
      "smoothness_deg", options.smoothness_deg, {0.1, 90.0}, "degrees",
      "largest angle between the normals of neighbours in one region, and of a cylinder's points with its side's");
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
  std::vector<CylinderAxis> axes;
  Segment remaining = segment;
  while (static_cast<int>(remaining.size()) >= options.region_size_min) {
    auto axis = take_cylinder(cloud, remaining, radius, options);
    if (!axis) break;
    axes.push_back(std::move(*axis));
  }
  refine_jointly(cloud, axes, radius, options);
  std::vector<TubePiece> pieces;
  for (const CylinderAxis& axis : axes) {
    if (static_cast<int>(axis.inliers.size()) < options.region_size_min) continue;
    TubePiece piece = make_piece(cloud, axis, radius);
    if (piece.length() > radius / 2.0) pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace tubebin::modeling
