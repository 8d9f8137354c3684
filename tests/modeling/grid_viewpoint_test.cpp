#include "modeling/input/grid_viewpoint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tubebin/core/geometry.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

/// As a camera at `place`, turned by `pose`, sees the surface z = height(x, y), by Newton's steps along each ray.
template <typename Height>
std::vector<cloud::Point> seen_surface(const Pose& pose, std::uint32_t width, std::uint32_t height, const Height& at) {
  std::vector<cloud::Point> points;
  for (std::uint32_t row = 0; row < height; ++row)
    for (std::uint32_t column = 0; column < width; ++column) {
      const Vec3 in_camera(double(column) - width / 2.0, double(row) - height / 2.0, 1.2 * width);
      const Vec3 ray = pose.linear() * in_camera.normalized(), eye = pose.translation();
      double range = -eye.z() / ray.z();
      for (int step = 0; step < 20; ++step) {
        const Vec3 p = eye + range * ray;
        range -= (p.z() - at(p.x(), p.y())) / ray.z();
      }
      points.push_back((eye + range * ray).cast<float>());
    }
  return points;
}

Pose oblique() {
  Pose pose = make_pose(Quat(0, 1, 0, 0), {0.4, -0.3, 1.1});
  pose.linear() = Eigen::AngleAxisd(0.3, Vec3(1, 1, 0).normalized()).toRotationMatrix() * pose.linear();
  return pose;
}

TEST(GridViewpoint, IsWhereTheCameraStands) {
  const auto waves = [](double x, double y) { return 0.03 * std::sin(20.0 * x) + 0.05 * std::cos(13.0 * y); };
  for (const Pose& pose : {make_pose(Quat(0, 1, 0, 0), {0.1, 0.2, 1.5}), oblique()}) {
    std::vector<cloud::Point> points = seen_surface(pose, 160, 100, waves);
    Random random(3);
    for (cloud::Point& point : points) {  // noise along the rays, and holes
      const Vec3 ray = (point.cast<double>() - pose.translation()).normalized();
      point += (0.001 * random.normal() * ray).cast<float>();
      if (random.uniform(0.0, 1.0) < 0.3) point = cloud::Point::Constant(std::numeric_limits<float>::quiet_NaN());
    }
    const auto viewpoint = viewpoint_of_grid(points, 160);
    ASSERT_TRUE(viewpoint.has_value());
    EXPECT_LT((*viewpoint - pose.translation()).norm(), 0.005);
  }
}

TEST(GridViewpoint, IsNowhereWhereThePointsDoNotSay) {
  EXPECT_FALSE(viewpoint_of_grid(seen_surface(oblique(), 160, 100, [](double, double) { return 0.0; }), 160));
  Random random(4);
  std::vector<cloud::Point> anywhere(16000);
  for (cloud::Point& point : anywhere) point = Vec3(random.normal(), random.normal(), random.normal()).cast<float>();
  EXPECT_FALSE(viewpoint_of_grid(anywhere, 160));
  EXPECT_FALSE(viewpoint_of_grid(std::span(anywhere).first(50), 10));
}

}  // namespace
}  // namespace tubebin::modeling
