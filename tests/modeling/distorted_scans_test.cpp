// Scans that were cropped, thinned, rounded, stretched or measured in another unit: whatever is found, the model is sound.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "modeling/built_scene.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::modeling {
namespace {

struct LooseScan {
  std::vector<cloud::Point> points;
  std::uint32_t width = 0;  ///< pixels; 0: in no order
  Vec3 viewpoint;
};

LooseScan scan_of_four_tubes() {
  scene::Scene scene = one_over_three();
  scene.scanner = looking_from({0.1, -0.5, 0.9});
  scene.scanner.region = scene::ScanRegion::full;
  scene.scanner.width = 480, scene.scanner.height = 300;
  const cloud::Cloud cloud = scan::scan(scene).cloud;
  return {.points = cloud.points, .width = cloud.width, .viewpoint = cloud.world_from_sensor.translation()};
}

/// Every so many rows and columns of a window.
void cut(LooseScan& scan, Random& random) {
  const auto height = static_cast<int>(scan.points.size() / scan.width), width = static_cast<int>(scan.width);
  const int left = random.integer(0, width / 2), top = random.integer(0, height / 2);
  const int right = random.integer(left + 1, width), bottom = random.integer(top + 1, height);
  const int columns_apart = random.integer(1, 4), rows_apart = random.integer(1, 4);
  std::vector<cloud::Point> points;
  for (int row = top; row < bottom; row += rows_apart)
    for (int column = left; column < right; column += columns_apart)
      points.push_back(scan.points[static_cast<std::size_t>(row * width + column)]);
  scan.points = std::move(points);
  scan.width = static_cast<std::uint32_t>((right - left + columns_apart - 1) / columns_apart);
}

/// Each of the distortions happens in some of the scans.
LooseScan distorted(LooseScan scan, Random& random) {
  const auto happens = [&](double share) { return random.uniform(0.0, 1.0) < share; };
  const auto any_of_size = [&](double low, double high) { return std::pow(10.0, random.uniform(low, high)); };
  if (happens(0.6)) cut(scan, random);
  const double noise = happens(0.3) ? any_of_size(-4.0, -1.5) : 0.0,
               step = happens(0.3) ? any_of_size(-4.0, -1.5) : 0.0;
  const double stretch = happens(0.2) ? any_of_size(-3.0, 1.0) : 1.0,
               unit = happens(0.4) ? any_of_size(-3.0, 3.5) : 1.0;
  const double missing = happens(0.2) ? random.uniform(0.0, 0.9) : 0.0;
  for (cloud::Point& point : scan.points) {
    Vec3 p = point.cast<double>() + noise * Vec3(random.normal(), random.normal(), random.normal());
    if (step > 0.0) p = (p / step).array().round() * step;
    p.z() *= stretch;
    point = (unit * p).cast<float>();
    if (happens(missing)) point.setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  scan.viewpoint = happens(0.3) ? Vec3(Vec3::Zero()) : Vec3(unit * scan.viewpoint);
  if (!happens(0.5)) return scan;
  for (std::size_t i = scan.points.size() - 1; i > 0; --i)
    std::swap(scan.points[i], scan.points[static_cast<std::size_t>(random.integer(0, static_cast<int>(i)))]);
  scan.width = 0;
  return scan;
}

void expect_sound(const ModelingResult& result, const std::vector<cloud::Point>& points) {
  ASSERT_EQ(result.labels.size(), result.source.size());
  ASSERT_EQ(result.all_labels.size(), points.size());
  EXPECT_TRUE(std::ranges::is_sorted(result.source));
  for (const std::uint32_t i : result.source) EXPECT_TRUE(cloud::is_finite(points.at(i)));
  for (const auto& labels : {result.labels, result.all_labels})
    for (const cloud::Label label : labels) ASSERT_LE(label, result.tubes.size());
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_TRUE(cloud::is_finite(points[i]) || result.all_labels[i] == 0);
  for (const TubeModel& tube : result.tubes) {
    EXPECT_GT(tube.radius, 0.0);
    for (const TubePath& path : tube.paths)
      for (const Vec3& node : path.nodes) EXPECT_TRUE(node.allFinite());
  }
}

TEST(DistortedScans, GiveSoundModels) {
  const LooseScan seen = scan_of_four_tubes();
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const LooseScan scan = distorted(seen, random);
    ModelingOptions options;
    options.label_all = true;
    expect_sound(model_tubes({.points = scan.points,
                              .world_from_sensor = Pose(Eigen::Translation3d(scan.viewpoint)),
                              .bin = {},
                              .width = scan.width},
                             options),
                 scan.points);
  }
}

}  // namespace
}  // namespace tubebin::modeling
