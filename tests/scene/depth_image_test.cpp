#include "tubebin/scene/depth_image.hpp"

#include <gmock/gmock.h>

#include "tubebin/core/error.hpp"

namespace tubebin::scene {
namespace {

Scanner of_range(double range_max) {
  Scanner scanner;  // at a height of 2 m, looking down
  scanner.range_max = range_max;
  return scanner;
}

TEST(DepthScale, IsTheFinestPowerOfTenThatHoldsTheRange) {
  EXPECT_EQ(DepthScale(of_range(0.5)).mm_per_unit(), 0.1);
  EXPECT_EQ(DepthScale(of_range(6.5535)).mm_per_unit(), 0.1);
  EXPECT_EQ(DepthScale(of_range(6.6)).mm_per_unit(), 1.0);
  EXPECT_EQ(DepthScale(of_range(66.0)).mm_per_unit(), 10.0);
}

TEST(DepthScale, RoundsDepthsAlongTheOpticalAxis) {
  const DepthScale scale(of_range(2.6));
  EXPECT_EQ(scale.depth({0.0F, 0.0F, 0.0F}), 20000);
  EXPECT_EQ(scale.depth({0.3F, -0.2F, 0.50004F}), 15000);
  EXPECT_EQ(scale.depth({0.3F, -0.2F, 0.50006F}), 14999);
  EXPECT_EQ(scale.depth({0.0F, 0.0F, -9.0F}), 65535);  // an outlier
  EXPECT_EQ(scale.depth({0.0F, 0.0F, 2.5F}), 0);       // behind it
}

TEST(DepthImage, IsRefusedOfACloudThatIsNoImage) {
  SceneRecord record;
  record.id = "A1/001";
  record.window = {10, 20, 3, 2};
  cloud::Cloud cloud;
  cloud.width = 6;
  cloud.height = 1;
  cloud.points.assign(6, cloud::Point::Zero());
  cloud.labels.assign(6, 1);
  EXPECT_THROW(depth_image(cloud, record), IoError);
  cloud.width = 3;
  cloud.height = 2;
  EXPECT_EQ(depth_image(cloud, record).labels, std::vector<std::uint16_t>(6, 1));
  cloud.labels.clear();
  EXPECT_THROW(depth_image(cloud, record), IoError);
}

}  // namespace
}  // namespace tubebin::scene
