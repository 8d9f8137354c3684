#include "physics/near_cylinders.hpp"

#include <gtest/gtest.h>

#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::physics {
namespace {

const std::vector<CylinderPair>& pairs(const NearCylinders& near_cylinders, std::size_t first, std::size_t second) {
  static const std::vector<CylinderPair> none;
  for (const NearTube& near : near_cylinders.near(second))
    if (near.first == first) return near.cylinders;
  return none;
}

/// Tubes that wander by steps of all sizes, some smaller and some larger than what makes a list anew.
TEST(NearCylinders, MissNoTouchWhileTubesMove) {
  Random random(5);
  std::vector<scene::PlacedTube> tubes;
  for (const tube::Tube& tube : tube::generate_tubes(6, {}, random))
    tubes.push_back({tube, make_pose(random.rotation(), Vec3(0, 0, random.uniform(0.0, 0.05)))});
  NearCylinders near_cylinders;
  std::size_t touches_found = 0, pairs_listed = 0, pairs_of_all = 0;
  for (int step = 0; step < 400; ++step) {
    std::vector<CollisionTube> shapes;
    for (scene::PlacedTube& tube : tubes) {
      const double size = random.uniform(0.0, 1.0) < 0.1 ? 0.02 : 0.0005;
      const auto some = [&] { return random.uniform(-size, size); };
      tube.world_from_tube.pretranslate(Vec3(some(), some(), some()));
      tube.world_from_tube.rotate(Eigen::AngleAxisd(5.0 * some(), Vec3::UnitX()));
      shapes.emplace_back(tube);
    }
    near_cylinders.follow(shapes, std::vector<double>(shapes.size(), 0.0));
    for (std::size_t j = 1; j < shapes.size(); ++j)
      for (std::size_t i = 0; i < j; ++i) {
        std::vector<Touch> expected, found;
        collide(shapes[i], shapes[j], 0.0, expected);
        collide(shapes[i], shapes[j], pairs(near_cylinders, i, j), 0.0, found);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
          EXPECT_EQ(found[k].position, expected[k].position);
          EXPECT_EQ(found[k].normal, expected[k].normal);
          EXPECT_EQ(found[k].depth, expected[k].depth);
        }
        touches_found += found.size();
        pairs_listed += pairs(near_cylinders, i, j).size();
        pairs_of_all += shapes[i].cylinders.size() * shapes[j].cylinders.size();
      }
  }
  EXPECT_GT(touches_found, 1000u);
  EXPECT_LT(pairs_listed, pairs_of_all / 2);
}

}  // namespace
}  // namespace tubebin::physics
