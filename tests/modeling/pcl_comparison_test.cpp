// The paper's method is PCL's region growing and RANSAC: the same regions and cylinders, point by point and bit by bit.
#include <gtest/gtest.h>
#include <pcl/console/print.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/region_growing.h>
#include <pcl/segmentation/sac_segmentation.h>

#include "modeling/built_scene.hpp"
#include "modeling/fitting/cylinder_ransac.hpp"
#include "modeling/fitting/nearest_neighbors.hpp"
#include "modeling/input/normals.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/modeling/region_growing.hpp"

namespace tubebin::modeling {
namespace {

struct PclCloud {
  pcl::PointCloud<pcl::PointXYZ>::Ptr points{new pcl::PointCloud<pcl::PointXYZ>};
  pcl::PointCloud<pcl::Normal>::Ptr normals{new pcl::PointCloud<pcl::Normal>};

  PclCloud(std::span<const cloud::Point> from, std::span<const cloud::Point> from_normals) {
    for (const cloud::Point& p : from) points->push_back(pcl::PointXYZ(p.x(), p.y(), p.z()));
    for (const cloud::Point& n : from_normals) normals->push_back(pcl::Normal(n.x(), n.y(), n.z()));
  }
};

/// A pile's points that have normals.
FilteredCloud pile(const std::string& scene, double ratio) {
  const cloud::Cloud cloud = cloud::read_cloud(TUBEBIN_SOURCE_DIR "/data/" + scene + "/cloud.pcd");
  const ModelingInput input = input_of(cloud, scene::Bin{});
  const ViewProjection projection = view_of(input);
  const FilteringOptions options{.ratio = ratio};
  FilteredCloud all = filter(input, projection, crop_bin(input, options), options, 7), dense;
  add_normals(all, projection, kRadius);
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    if (all.normals[i].isZero()) continue;
    dense.points.push_back(all.points[i]);
    dense.normals.push_back(all.normals[i]);
  }
  return dense;
}

std::vector<Segment> regions_of_pcl(const FilteredCloud& cloud, const RegionGrowingOptions& options) {
  const PclCloud input(cloud.points, cloud.normals);
  pcl::RegionGrowing<pcl::PointXYZ, pcl::Normal> growing;
  growing.setMinClusterSize(options.region_size_min);
  growing.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
  growing.setNumberOfNeighbours(static_cast<unsigned>(options.neighbors));
  growing.setInputCloud(input.points);
  growing.setInputNormals(input.normals);
  growing.setSmoothnessThreshold(static_cast<float>(radians(options.smoothness_deg)));
  std::vector<pcl::PointIndices> clusters;
  growing.extract(clusters);
  std::vector<Segment> regions;
  for (const pcl::PointIndices& cluster : clusters)
    regions.emplace_back(cluster.indices.begin(), cluster.indices.end());
  return regions;
}

/// A point on the axis and its direction; empty where there is none.
std::vector<float> cylinder_of_pcl(std::span<const cloud::Point> points, std::span<const cloud::Point> normals,
                                   const CylinderSearch& search) {
  const PclCloud input(points, normals);
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  pcl::SACSegmentationFromNormals<pcl::PointXYZ, pcl::Normal> sac;
  sac.setModelType(pcl::SACMODEL_CYLINDER);
  sac.setMethodType(pcl::SAC_RANSAC);
  sac.setNormalDistanceWeight(0.05);
  sac.setMaxIterations(search.iterations);
  sac.setDistanceThreshold(search.inlier_distance);
  sac.setRadiusLimits(0.8 * search.radius, 1.2 * search.radius);
  sac.setOptimizeCoefficients(false);
  sac.setInputCloud(input.points);
  sac.setInputNormals(input.normals);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients coefficients;
  sac.segment(inliers, coefficients);
  if (inliers.indices.size() < 5) return {};
  return {coefficients.values.begin(), coefficients.values.begin() + 6};
}

class PclComparison : public ::testing::TestWithParam<double> {};

TEST_P(PclComparison, RegionsAreTheSame) {
  for (const std::string scene : {"A10/003", "B10/002"})
    for (const double smoothness_deg : {6.0, RegionGrowingOptions{}.smoothness_deg}) {
      const FilteredCloud cloud = pile(scene, GetParam());
      const RegionGrowingOptions options{.smoothness_deg = smoothness_deg};
      const std::vector<Segment> regions = grow_regions(cloud, options);
      EXPECT_GT(regions.size(), 10U);
      EXPECT_EQ(regions, regions_of_pcl(cloud, options)) << scene << " at " << smoothness_deg << " degrees";
    }
}

TEST_P(PclComparison, CylindersAreTheSame) {
  const FilteredCloud cloud = pile("A10/003", GetParam());
  const CylinderSearch search{.radius = kRadius, .inlier_distance = 0.15 * kRadius, .iterations = 100};
  int found = 0, none = 0;
  for (const Segment& region : grow_regions(cloud, {.region_size_min = 8})) {
    std::vector<cloud::Point> points, normals;
    for (const std::uint32_t i : region) {
      points.push_back(cloud.points[i]);
      normals.push_back(cloud.normals[i]);
    }
    std::vector<float> cylinder;
    if (const auto axis = search_cylinder(points, normals, search))
      for (const Vec3& v : {axis->point, axis->direction})
        for (const double x : v) cylinder.push_back(static_cast<float>(x));
    const std::vector<float> expected = cylinder_of_pcl(points, normals, search);
    ASSERT_EQ(cylinder.size(), expected.size());
    // PCL gives the direction before it is normalized in double precision.
    for (std::size_t k = 0; k < cylinder.size(); ++k) EXPECT_FLOAT_EQ(cylinder[k], expected[k]);
    ++(cylinder.empty() ? none : found);
  }
  EXPECT_GT(found, 15);
  EXPECT_GT(none, 0);
}

INSTANTIATE_TEST_SUITE_P(Ratios, PclComparison, ::testing::Values(0.3, 1.0));

TEST(NearestNeighbors, AreThoseOfAllDistances) {
  Random random(3);
  std::vector<cloud::Point> points;
  for (int i = 0; i < 500; ++i)  // on a coarse grid, so that some are equally far and some in one place
    points.emplace_back(float(random.integer(0, 12)), float(random.integer(0, 6)), float(random.integer(0, 3)));
  const NearestNeighbors nearest(points);
  for (const std::size_t count : {std::size_t{1}, std::size_t{20}, points.size() + 1})
    for (const cloud::Point& query : points) {
      std::vector<float> distances, found;
      for (const cloud::Point& p : points) distances.push_back((p - query).squaredNorm());
      std::ranges::sort(distances);
      distances.resize(std::min(count, points.size()));
      for (const std::uint32_t i : nearest.find(query, count)) found.push_back((points[i] - query).squaredNorm());
      EXPECT_EQ(found, distances);
    }
}

}  // namespace
}  // namespace tubebin::modeling
