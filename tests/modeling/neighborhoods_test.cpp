#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include "modeling/built_surface.hpp"
#include "modeling/fitting/end_growth.hpp"
#include "modeling/fitting/surface_fitting.hpp"
#include "modeling/fitting/vote_voxels.hpp"
#include "modeling/input/normals.hpp"
#include "modeling/input/view_grid.hpp"
#include "tubebin/core/random.hpp"
#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {
namespace {

/// The upper side of a tube of kRadius along x, and its normals.
struct HalfTube {
  std::vector<cloud::Point> points, normals;

  explicit HalfTube(std::size_t count) {
    Random random(7);
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = random.uniform(-1.2, 1.2);
      const Vec3 normal(0.0, std::sin(angle), std::cos(angle));
      points.push_back((Vec3(random.uniform(-0.05, 0.05), 0.0, 0.0) + kRadius * normal).cast<float>());
      normals.push_back(normal.cast<float>());
    }
  }
};

/// The plane's normal through all points within `radius` of points[i], by an eigensolver.
cloud::Point plane_through_neighbors(const std::vector<cloud::Point>& points, std::size_t i, double radius) {
  Vec3 mean = Vec3::Zero();
  std::vector<Vec3> near;
  for (const cloud::Point& point : points)
    if ((point - points[i]).norm() <= static_cast<float>(radius)) near.push_back(point.cast<double>());
  for (const Vec3& point : near) mean += point / static_cast<double>(near.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vec3& point : near) covariance += (point - mean) * (point - mean).transpose();
  const Vec3 normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(0);
  return (normal.z() < 0.0 ? Vec3(-normal) : normal).cast<float>();
}

FilteredCloud cloud_of(const std::vector<cloud::Point>& points) {
  return {.source = std::vector<std::uint32_t>(points.size(), 7), .points = points, .normals = {}, .spacing = 0.001};
}

std::vector<cloud::Point> normals_of(const std::vector<cloud::Point>& points, double radius) {
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0U);
  const FilteredCloud cloud = cloud_of(points);
  return SurfaceNormals(cloud, view_from_above(), radius).at(all);
}

TEST(ViewProjection, OfManyPointsIsThatOfEach) {
  const ViewProjection projection = view_from_above();
  for (const std::size_t count : {0, 1, 7, 8, 9, 100}) {
    const std::vector<cloud::Point> points = HalfTube(count).points;
    const ViewProjection::Images images = projection.images(points);
    ASSERT_EQ(images.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      const ViewProjection::Image image = projection(points[i]);
      EXPECT_EQ(images.u[i], image.u);
      EXPECT_EQ(images.v[i], image.v);
      EXPECT_EQ(images.range[i], image.range);
      EXPECT_NEAR(image.range, (points[i] - projection.viewpoint()).norm(), 1e-6);
    }
  }
}

TEST(RangeImage, LeavesOutWhatIsNotFinite) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  // Each would lie right in front of the scanner, were its other coordinates believed.
  const std::vector<cloud::Point> points = {{0.0f, 0.0f, 0.0f},   {kNaN, 0.0f, 0.9f},      {0.0f, kNaN, 0.9f},
                                            {0.0f, 0.0f, kNaN},   {0.0f, kInfinity, 0.9f}, {0.0f, 0.0f, -kInfinity},
                                            {0.01f, 0.01f, 0.01f}};
  const RangeImage image(view_from_above(), points, 0.002f);
  EXPECT_EQ(image.evidence({0.0f, 0.0f, 0.0f}, 0.001f), RangeImage::Evidence::surface);
  EXPECT_EQ(image.evidence({0.0f, 0.0f, -0.1f}, 0.001f), RangeImage::Evidence::hidden);
  EXPECT_EQ(image.evidence({0.0f, 0.0f, 0.1f}, 0.001f), RangeImage::Evidence::empty);
  EXPECT_EQ(RangeImage(view_from_above(), std::span(points).subspan(1, 5), 0.002f).evidence({0.0f, 0.0f, 0.0f}, 0.001f),
            RangeImage::Evidence::beyond);
}

TEST(RangeImage, TakesNoMoreCellsThanFitIntoMemory) {
  const std::vector<cloud::Point> points = {{0.1f, 0.2f, 0.0f}, {-0.3f, -0.2f, 0.1f}, {0.0f, 0.0f, 0.9999f}};
  for (const float cell : {1e-7f, 0.0f}) {
    const RangeImage image(view_from_above(), points, cell);
    for (const cloud::Point& point : points) EXPECT_EQ(image.evidence(point, 0.001f), RangeImage::Evidence::surface);
    EXPECT_EQ(RangeImage(view_from_above(), std::span(points).first(1), cell).evidence(points.front(), 0.001f),
              RangeImage::Evidence::surface);
  }
}

TEST(Normals, AreThoseOfAnEigensolver) {
  constexpr double kReach = 0.004;
  const HalfTube tube(3000);
  const std::vector<cloud::Point> normals = normals_of(tube.points, kReach);
  for (std::size_t i = 0; i < tube.points.size(); i += 10) {
    ASSERT_NEAR(normals[i].norm(), 1.0f, 1e-5f);
    EXPECT_GT(normals[i].dot(plane_through_neighbors(tube.points, i, kReach)), 0.9995f);
    EXPECT_GT(normals[i].dot(tube.normals[i]), 0.9f);
  }
}

TEST(Normals, AreZeroWhereNeighborsSpanNoPlane) {
  std::vector<cloud::Point> points = {{0.0f, 0.0f, 0.0f}, {0.001f, 0.0f, 0.0f}, {0.0f, 0.001f, 0.0f}};
  for (int i = 0; i < 20; ++i) points.emplace_back(0.1f + 0.0005f * static_cast<float>(i), 0.1f, 0.0f);
  for (const cloud::Point& normal : normals_of(points, 0.004)) EXPECT_TRUE(normal.isZero());
  EXPECT_TRUE(normals_of({}, 0.004).empty());
}

TEST(Normals, OfAPartOfThePointsAreThoseThatAllOfThemGive) {
  const HalfTube tube(3000);
  const std::vector<cloud::Point> all = normals_of(tube.points, 0.004);
  const FilteredCloud cloud = cloud_of(tube.points);
  const std::vector<std::uint32_t> some = {2999, 7, 8, 1500, 7};
  const std::vector<cloud::Point> part = SurfaceNormals(cloud, view_from_above(), 0.004).at(some);
  ASSERT_EQ(part.size(), some.size());
  for (std::size_t k = 0; k < part.size(); ++k) EXPECT_EQ(part[k], all[some[k]]);
}

TEST(Thinned, LeavesPointsAboutAsFarApartAsAsked) {
  const HalfTube tube(3000);
  const FilteredCloud cloud = cloud_of(tube.points);
  const SurfaceNormals normals(cloud, view_from_above(), 0.004);
  const FilteredCloud same = thinned(cloud, 0.001, normals);
  EXPECT_EQ(same.points, cloud.points);
  const FilteredCloud sample = thinned(cloud, 0.002, normals);
  EXPECT_EQ(sample.points.size(), (cloud.points.size() + 3) / 4);
  EXPECT_DOUBLE_EQ(sample.spacing, 0.002);
  EXPECT_EQ(sample.source.size(), sample.points.size());
  EXPECT_EQ(sample.normals.size(), sample.points.size());
}

TEST(Neighborhoods, HoldThePointsWithinTheReach) {
  constexpr double kReach = 0.003;
  const std::vector<cloud::Point> points = HalfTube(500).points;
  const std::vector<int> counts = count_neighbors(view_from_above(), points, kReach);
  const FilteredCloud cloud = cloud_of(points);
  const SurfaceNormals narrower(cloud, view_from_above(), 0.7 * kReach);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    std::vector<std::uint32_t> within, found = narrower.around(i, kReach);
    for (std::uint32_t k = 0; k < points.size(); ++k)
      if ((points[k] - points[i]).norm() <= static_cast<float>(kReach)) within.push_back(k);
    EXPECT_EQ(counts[i], within.size());
    std::ranges::sort(found);
    EXPECT_EQ(found, within);
  }
}

TEST(VoteVoxels, HoldTheMeansOfTheirVotes) {
  constexpr float kVoxel = 0.004f;
  const std::vector<cloud::Point> votes = HalfTube(2000).points;
  const VoteVoxels voxels(votes, kVoxel, 3);
  std::map<std::array<int, 3>, std::vector<cloud::Point>> cells;
  const auto cell_of = [&](const cloud::Point& vote) {
    const Eigen::Array3f cell = (vote.array() * (1.0f / kVoxel)).floor();
    return std::array{static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())};
  };
  for (const cloud::Point& vote : votes) cells[cell_of(vote)].push_back(vote);
  for (std::size_t i = 0; i < votes.size(); ++i) {
    const std::vector<cloud::Point>& own = cells[cell_of(votes[i])];
    if (own.size() < 3) {
      EXPECT_EQ(voxels.voxel_of(i), VoteVoxels::kNone);
      continue;
    }
    cloud::Point mean = cloud::Point::Zero();
    for (const cloud::Point& vote : own) mean += vote / static_cast<float>(own.size());
    EXPECT_EQ(voxels.count(voxels.voxel_of(i)), own.size());
    EXPECT_LT((voxels.mean(voxels.voxel_of(i)) - mean).norm(), 1e-7f);
  }
}

/// A polyline's upper side: at each place along it, points around the half that faces up.
std::vector<SurfacePoint> upper_side(const std::vector<Vec3>& nodes, double radius) {
  std::vector<SurfacePoint> points;
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const Vec3 along = (nodes[k + 1] - nodes[k]).normalized(), side = along.cross(Vec3::UnitZ()).normalized();
    for (double t = 0.01; t < 1.0; t += 0.02)
      for (double angle = -1.2; angle <= 1.2; angle += 0.2) {
        const Vec3 normal = std::sin(angle) * side + std::cos(angle) * side.cross(along);
        points.push_back({nodes[k] + t * (nodes[k + 1] - nodes[k]) + radius * normal, normal});
      }
  }
  return points;
}

TEST(SurfaceFitting, FindsThePolylineThatPointsLieAbout) {
  const std::vector<Vec3> truth = {{0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, {0.18, 0.06, 0.0}, {0.2, 0.15, 0.0}};
  std::vector<Vec3> nodes = truth;
  for (std::size_t k = 0; k < nodes.size(); ++k) nodes[k] += Vec3(0.0, k % 2 == 0 ? 0.002 : -0.002, 0.001);
  const SurfaceFit fit = fit_surface(nodes, upper_side(truth, kRadius), kRadius);
  EXPECT_LT(fit.sigma, 1e-5);
  // Where both neighbours pin a node down. An end is free to slide along its cylinder.
  for (const std::size_t k : {1, 2}) EXPECT_LT((nodes[k] - truth[k]).norm(), 1e-4);
}

TEST(SurfaceFitting, GrowsAnEndAsFarAsItsPointsReach) {
  const std::vector<Vec3> truth = {{0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, {0.18, 0.05, 0.0}};
  FilteredCloud cloud{.source = {}, .points = {}, .normals = {}, .spacing = 0.002};
  Segment own;
  for (const SurfacePoint& point : upper_side(truth, kRadius)) {
    own.push_back(static_cast<std::uint32_t>(cloud.points.size()));
    cloud.points.push_back(point.position.cast<float>());
    cloud.normals.push_back(point.normal.cast<float>());
  }
  std::vector<Vec3> nodes = {{0.01, 0.0, 0.0}, {0.05, 0.0, 0.0}};
  grow_end(nodes, cloud, own, {}, kRadius, Vec3(0.0, 0.0, 1.0));
  const Vec3 last_points = truth[1] + 0.99 * (truth[2] - truth[1]);
  EXPECT_LT((nodes.back() - last_points).norm(), 0.003);
  for (const Vec3& node : nodes) EXPECT_LT(distance_to_polyline(node, truth), 0.1 * kRadius);
}

}  // namespace
}  // namespace tubebin::modeling
