#include "tubebin/scene/pile_relations.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "physics/collision.hpp"
#include "tubebin/physics/drop_simulator.hpp"
#include "tubebin/scene/tubes_txt.hpp"
#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::physics {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

scene::PlacedTube polyline(const std::vector<Vec3>& nodes) {
  scene::PlacedTube placed{{.radius = 0.0125, .nodes = nodes, .cylinders = {}}, Pose::Identity()};
  for (int i = 0; i + 1 < static_cast<int>(nodes.size()); ++i) placed.tube.cylinders.push_back({i, i + 1, i});
  return placed;
}

scene::PlacedTube bar(const Vec3& a, const Vec3& b) { return polyline({a, b}); }

/// Deepest that the tube runs into the other while it is raised by half a metre, metres.
double depth_while_lifted(const scene::PlacedTube& tube, const scene::PlacedTube& other) {
  const CollisionTube standing(other);
  scene::PlacedTube raised = tube;
  double deepest = 0.0;
  std::vector<Touch> touches;
  for (int step = 0; step <= 1000; ++step) {
    touches.clear();
    collide(CollisionTube(raised), standing, 1e-3, touches);
    for (const Touch& touch : touches) deepest = std::max(deepest, touch.depth);
    raised.world_from_tube.pretranslate(Vec3(0, 0, 0.0005));
  }
  return deepest;
}

/// Lifting each tube in small steps with the collision code of the simulation runs into exactly those that are above.
/// Between grazing and clearly in the way (less than 1.8 mm of overlap, or steps too coarse to tell) either is right.
int expect_agreement_with_lifting(const std::vector<scene::PlacedTube>& tubes) {
  const std::vector<scene::Above> above = scene::find_above(tubes);
  int pairs = 0;
  for (std::uint32_t lower = 1; lower <= tubes.size(); ++lower)
    for (std::uint32_t upper = 1; upper <= tubes.size(); ++upper) {
      if (upper == lower) continue;
      const bool is_above = std::ranges::find(above, scene::Above{upper, lower}) != above.end();
      const double depth = depth_while_lifted(tubes[lower - 1], tubes[upper - 1]);
      EXPECT_TRUE(!is_above || depth > 0.0) << upper << " above " << lower;
      EXPECT_TRUE(is_above || depth <= 1.8e-3) << upper << " above " << lower << ", " << depth * 1e3 << " mm";
      pairs += is_above ? 1 : 0;
    }
  return pairs;
}

TEST(PileRelations, ACrossIsLiftedFromAbove) {
  const std::vector<scene::PlacedTube> tubes = {bar({-0.2, 0, 0.02}, {0.2, 0, 0.02}),
                                                bar({0, -0.1, 0.06}, {0, 0.1, 0.06})};
  EXPECT_THAT(scene::find_above(tubes), ElementsAre(scene::Above{2, 1}));
  scene::PileRelations relations;
  relations.above = scene::find_above(tubes);
  EXPECT_FALSE(relations.is_liftable(1));
  EXPECT_TRUE(relations.is_liftable(2));
  EXPECT_THAT(scene::entangled_groups(2, scene::find_above(tubes)), IsEmpty());
}

TEST(PileRelations, TubesSideBySideAreNotAboveEachOther) {
  EXPECT_THAT(
      scene::find_above({bar({-0.2, 0, 0.0125}, {0.2, 0, 0.0125}), bar({-0.2, 0.0245, 0.013}, {0.2, 0.0245, 0.013})}),
      IsEmpty());
  EXPECT_THAT(
      scene::find_above({bar({-0.2, 0, 0.0125}, {0.2, 0, 0.0125}), bar({-0.2, 0.0235, 0.023}, {0.2, 0.0235, 0.023})}),
      ElementsAre(scene::Above{2, 1}));
}

TEST(PileRelations, EndsAreFlat) {
  // The upper tube's flat end stops 1 mm before the lower tube; a rounded one would reach over it.
  EXPECT_THAT(scene::find_above({bar({0, -0.1, 0.02}, {0, 0.1, 0.02}), bar({0.0135, 0, 0.1}, {0.2, 0, 0.1})}),
              IsEmpty());
  EXPECT_THAT(scene::find_above({bar({0, -0.1, 0.02}, {0, 0.1, 0.02}), bar({0.0105, 0, 0.1}, {0.2, 0, 0.1})}),
              ElementsAre(scene::Above{2, 1}));
}

TEST(PileRelations, AnUprightTubeAndABallAreSolidsToo) {
  const scene::PlacedTube ball{{.radius = 0.02, .nodes = {{0, 0, 0.3}}, .cylinders = {}}, Pose::Identity()};
  EXPECT_THAT(scene::find_above({bar({0, 0, 0}, {0, 0, 0.2}), ball}), ElementsAre(scene::Above{2, 1}));
  EXPECT_THAT(scene::find_above({bar({0.0330, 0, 0}, {0.0330, 0, 0.2}), ball}), IsEmpty());
}

TEST(PileRelations, HookedTubesAreAGroupAndTheOneOnTopIsNot) {
  // Two staples, one through the other: each passes over and under the other.
  const scene::PlacedTube first = polyline({{-0.2, 0.0, 0.02}, {0.0, 0.0, 0.1}, {0.2, 0.0, 0.02}});
  const scene::PlacedTube second =
      polyline({{-0.1, -0.1, 0.15}, {-0.1, 0.1, 0.15}, {0.1, 0.1, 0.02}, {0.1, -0.1, 0.02}});
  const scene::PlacedTube on_top = bar({-0.1, -0.1, 0.3}, {-0.1, 0.1, 0.3});
  const auto above = scene::find_above({first, second, on_top});
  EXPECT_THAT(above, ElementsAre(scene::Above{1, 2}, scene::Above{2, 1}, scene::Above{3, 1}, scene::Above{3, 2}));
  EXPECT_THAT(scene::entangled_groups(3, above), ElementsAre(ElementsAre(1U, 2U)));
}

TEST(PileRelations, GroupsAreTheCyclesOfAbove) {
  EXPECT_THAT(scene::entangled_groups(6, {{1, 2}, {2, 3}, {3, 1}, {4, 1}, {5, 6}, {6, 5}}),
              ElementsAre(ElementsAre(1U, 2U, 3U), ElementsAre(5U, 6U)));
  EXPECT_THAT(scene::entangled_groups(3, {{1, 2}, {2, 3}, {1, 3}}), IsEmpty());
  EXPECT_THAT(scene::entangled_groups(0, {}), IsEmpty());
}

TEST(PileRelations, AgreesWithLiftingADroppedPile) {
  Random random(77);
  tube::TubeOptions options;
  options.bend_angle_max_deg = 45.0;
  const std::vector<tube::Tube> tubes = tube::generate_tubes(6, options, random);
  DropResult drop;
  std::uint64_t seed = 0;
  do {
    drop = drop_tubes(tubes, scene::Bin{}, PhysicsOptions{}, ++seed);
  } while (drop.failure != DropFailure::none && seed < 10);
  ASSERT_EQ(drop.failure, DropFailure::none) << drop.detail;
  EXPECT_GT(expect_agreement_with_lifting(drop.tubes), 3);
  const auto above = scene::find_above(drop.tubes);
  for (std::uint32_t label = 1; label <= drop.tubes.size(); ++label)
    EXPECT_EQ(scene::has_above(drop.tubes, label),
              std::ranges::any_of(above, [&](const scene::Above& pair) { return pair.lower == label; }));
}

TEST(PileRelations, AgreesWithLiftingPublishedPiles) {
  for (const char* name : {"A5_1", "B10_1", "C5_1"}) {
    const std::string path = std::string(PUBLISHED_SCENES_DIR "/") + name + ".txt";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs the published scenes in " PUBLISHED_SCENES_DIR;
    SCOPED_TRACE(name);
    EXPECT_GT(expect_agreement_with_lifting(scene::read_tubes_txt(path)), 2);
  }
}

TEST(PileRelations, CenterlinesFollowTheGraph) {
  EXPECT_THAT(scene::centerline_paths(polyline({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}}).tube),
              ElementsAre(ElementsAre(0, 1, 2)));
  tube::Tube tube{.radius = 0.01,
                  .nodes = std::vector<Vec3>(6),
                  .cylinders = {{3, 1, 0}, {0, 1, 0}, {1, 2, 0}, {2, 4, 1}, {1, 5, 0}}};
  EXPECT_THAT(scene::centerline_paths(tube),
              ElementsAre(ElementsAre(0, 1), ElementsAre(1, 3), ElementsAre(1, 2, 4), ElementsAre(1, 5)));
  tube.nodes.resize(3);
  tube.cylinders = {{0, 1, 0}, {1, 2, 1}, {2, 0, 2}};
  EXPECT_THAT(scene::centerline_paths(tube), ElementsAre(ElementsAre(0, 1, 2, 0)));
  tube.nodes.resize(1);
  tube.cylinders.clear();
  EXPECT_THAT(scene::centerline_paths(tube), ElementsAre(ElementsAre(0)));
}

}  // namespace
}  // namespace tubebin::physics
