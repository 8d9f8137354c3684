// Planes of least squares through blocks of a scan's points.
#include "modeling/input/flat_blocks.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

/// Points about a place, scattered along random axes by these standard deviations, metres.
PointMoments scattered(const Vec3& place, const Vec3& sigmas, Random& random) {
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
  PointMoments moments;
  for (int i = 0; i < 16; ++i)
    moments.add(place +
                turn * Vec3(sigmas.x() * random.normal(), sigmas.y() * random.normal(), sigmas.z() * random.normal()));
  return moments;
}

TEST(FittedPlane, IsThatOfAGeneralSolver) {
  Random random(3);
  for (const double off_plane : {3e-3, 1e-3, 1e-4, 1e-6, 0.0})
    for (int i = 0; i < 200; ++i) {
      const PointMoments moments = scattered(Vec3(0.1, -0.2, 0.3), Vec3(4e-3, 3e-3, off_plane), random);
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moments.covariance());
      const FittedPlane plane(moments);
      // Positions of a decimetre, squared, are rounded by 1e-18 square metres.
      EXPECT_NEAR(plane.mean_square, std::max(eigen.eigenvalues()(0), 0.0), 1e-6 * eigen.eigenvalues()(0) + 1e-16);
      EXPECT_NEAR(plane_residual(moments), plane.mean_square, 0.0);
      const double apart = eigen.eigenvalues()(1) - eigen.eigenvalues()(0);
      if (apart < 1e-3 * eigen.eigenvalues()(2)) continue;  // more than one normal is as good
      EXPECT_GT(std::abs(plane.normal.dot(eigen.eigenvectors().col(0))), 1.0 - 1e-6);
    }
}

TEST(FittedPlane, OfPointsOnALineHasNoResidual) {
  PointMoments moments;
  for (int i = 0; i < 16; ++i) moments.add(i * Vec3(0.001, 0.002, -0.001));
  EXPECT_LT(plane_residual(moments), 1e-12);
  PointMoments point;
  for (int i = 0; i < 16; ++i) point.add(Vec3(0.1, 0.2, 0.3));
  EXPECT_LT(plane_residual(point), 1e-12);
}

}  // namespace
}  // namespace tubebin::modeling
