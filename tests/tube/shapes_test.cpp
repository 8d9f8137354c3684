#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::tube {
namespace {

using ::testing::HasSubstr;

/// Reads `tube: {...}` as a configuration does, and checks it.
TubeOptions read_tube(const std::string& yaml) {
  TubeOptions options;
  const auto describe_all = [&](Fields& fields) {
    fields.group("tube", "", [&](Fields& inner) { describe(inner, options); });
  };
  const KeyPlaces places = read_yaml_text(yaml, "test.yaml", describe_all);
  check(options, places, "tube");
  return options;
}

std::string problem_with(const std::string& yaml) {
  try {
    read_tube(yaml);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0));
}

/// Whether every node can be reached from the first.
bool is_connected(const Tube& tube) {
  std::vector<bool> reached(tube.nodes.size(), false);
  reached[0] = true;
  for (std::size_t round = 0; round < tube.nodes.size(); ++round)
    for (const Cylinder& c : tube.cylinders) {
      const bool either = reached[static_cast<std::size_t>(c.node_a)] || reached[static_cast<std::size_t>(c.node_b)];
      reached[static_cast<std::size_t>(c.node_a)] = reached[static_cast<std::size_t>(c.node_b)] = either;
    }
  return std::ranges::all_of(reached, std::identity());
}

constexpr const char* kFork = R"(tube:
  shape: branching
  junction_angle_min_deg: 40
  paths:
    - {from: 1, to: 2, length: 0.3, cylinder_count_min: 5, cylinder_count_max: 10, bend_angle_max_deg: 20}
    - {from: 1, to: 3, length: 0.1, cylinder_count_min: 2, cylinder_count_max: 5, bend_angle_max_deg: 10}
    - {from: 1, to: 4, length: 0.1, cylinder_count_min: 2, cylinder_count_max: 5, bend_angle_max_deg: 10}
    - {from: 2, to: 5, length: 0.1, cylinder_count_min: 2, cylinder_count_max: 5, bend_angle_max_deg: 10}
    - {from: 2, to: 6, length: 0.15, cylinder_count_min: 2, cylinder_count_max: 6, bend_angle_max_deg: 10}
)";

/// The paths of a tube, told apart by their cylinders' orders: each begins where the order is 0.
std::vector<std::vector<Cylinder>> paths_of(const Tube& tube) {
  std::vector<std::vector<Cylinder>> paths;
  for (const Cylinder& cylinder : tube.cylinders) {
    if (cylinder.order == 0) paths.emplace_back();
    paths.back().push_back(cylinder);
  }
  return paths;
}

TEST(Branching, IsATreeOfPathsWithTheirOwnLengthsCountsAndBends) {
  const TubeOptions options = read_tube(kFork);
  const double lengths[] = {0.3, 0.1, 0.1, 0.1, 0.15};
  const std::size_t fewest[] = {5, 2, 2, 2, 2}, most[] = {10, 5, 5, 5, 6};
  Random random(1);
  for (const Tube& tube : generate_tubes(100, options, random)) {
    EXPECT_EQ(tube.nodes.size(), tube.cylinders.size() + 1);  // connected and without loops
    EXPECT_TRUE(is_connected(tube));
    const std::vector<int> degrees = tube.node_degrees();
    EXPECT_EQ(std::ranges::count(degrees, 1), 4);
    EXPECT_EQ(std::ranges::count(degrees, 3), 2);
    const auto paths = paths_of(tube);
    ASSERT_EQ(paths.size(), 5u);
    for (std::size_t i = 0; i < paths.size(); ++i) {
      EXPECT_GE(paths[i].size(), fewest[i]);
      EXPECT_LE(paths[i].size(), most[i]);
      double length = 0.0;
      for (std::size_t k = 0; k < paths[i].size(); ++k) {
        EXPECT_EQ(paths[i][k].order, static_cast<int>(k));
        EXPECT_GE(tube.length(paths[i][k]), 0.02 - 1e-12);
        length += tube.length(paths[i][k]);
        if (k == 0) continue;
        EXPECT_EQ(paths[i][k].node_a, paths[i][k - 1].node_b);
        const auto direction = [&](const Cylinder& c) -> Vec3 {
          return tube.nodes[static_cast<std::size_t>(c.node_b)] - tube.nodes[static_cast<std::size_t>(c.node_a)];
        };
        EXPECT_LE(angle_between(direction(paths[i][k - 1]), direction(paths[i][k])),
                  radians(i == 0 ? 20.0 : 10.0) + 1e-7);
      }
      EXPECT_NEAR(length, lengths[i], 1e-12);
    }
    for (std::size_t node = 0; node < degrees.size(); ++node) {
      const std::vector<Vec3> arms = tube.directions_from(static_cast<int>(node));
      if (arms.size() < 3) continue;
      for (std::size_t a = 0; a < arms.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) EXPECT_GE(angle_between(arms[a], arms[b]), radians(40.0) - 1e-9);
    }
  }
}

TEST(Branching, RefusesWhatIsNoTree) {
  EXPECT_THAT(problem_with("tube:\n  shape: branching\n"), HasSubstr("test.yaml:2:3: tube.paths: missing"));
  const std::string fork = "tube:\n  shape: branching\n  paths:\n    - {from: 1, to: 2}\n    - ";
  EXPECT_THAT(problem_with(fork + "{from: 3, to: 4}\n"), HasSubstr("test.yaml:5:14: tube.paths[1].from: no earlier"));
  EXPECT_THAT(problem_with(fork + "{from: 2, to: 1}\n"), HasSubstr("test.yaml:5:21: tube.paths[1].to: the node 1"));
  EXPECT_THAT(problem_with(fork + "{from: 2, to: 2}\n"), HasSubstr("tube.paths[1].to: the node 2"));
  EXPECT_THAT(problem_with(fork + "{from: 2, to: 3, length: 0.1}\n"), HasSubstr("tube.paths[1].cylinder_length_min"));
  EXPECT_THAT(problem_with(fork + "{from: 2, to: 3, lenght: 0.1}\n"), HasSubstr("did you mean 'length'?"));
  EXPECT_THAT(problem_with(fork + "7\n"), HasSubstr("test.yaml:5:7: tube.paths[1]: '7' is not valid"));
  EXPECT_THAT(problem_with(fork + "{from: 2, to: 3}\n    - {from: 2, to: 4}\n  junction_angle_min_deg: 120\n"),
              HasSubstr("test.yaml:7:27: tube.junction_angle_min_deg: 120 degrees leave no room for the 3 paths"));
  EXPECT_THAT(problem_with("tube: {shape: branching, paths: []}\n"), HasSubstr("a list of mappings"));
}

TEST(Shapes, HaveNoKeysOfEachOther) {
  EXPECT_THAT(problem_with("tube:\n  shape: ring\n  bend_angle_max_deg: 20\n"),
              HasSubstr("test.yaml:3:3: tube.bend_angle_max_deg: unknown key"));
  EXPECT_THAT(problem_with("tube: {shape: chain, diameter_min: 0.2}\n"), HasSubstr("unknown key"));
  EXPECT_THAT(problem_with("tube: {shape: cube}\n"), HasSubstr("one of chain, branching, ring, sphere, curve"));
}

TEST(Shapes, AreReadBackAsTheyAreWritten) {
  TubeOptions options = read_tube(kFork);
  const auto fields_of = [](TubeOptions& tube) {
    return [&tube](Fields& fields) { fields.group("tube", "", [&tube](Fields& inner) { describe(inner, tube); }); };
  };
  const std::string text = write_yaml(fields_of(options));
  TubeOptions back = read_tube(text);
  EXPECT_EQ(write_yaml(fields_of(back)), text);
  EXPECT_THAT(list_fields(fields_of(back)), ::testing::Contains(KeyValue{"tube.paths[4].length", "0.15"}));
}

TEST(Shapes, CopiesHaveOptionsOfTheirOwn) {
  const TubeOptions wide = read_tube("tube: {shape: ring, diameter_min: 0.2, diameter_max: 0.2}\n");
  TubeOptions narrow = wide;
  read_yaml_text("diameter_min: 0.1\ndiameter_max: 0.1\n", "test.yaml",
                 [&](Fields& fields) { narrow.shape->describe(fields, narrow); });
  Random random(1);
  EXPECT_NEAR(generate_tubes(1, wide, random)[0].nodes[0].norm(), 0.1, 1e-12);
  EXPECT_NEAR(generate_tubes(1, narrow, random)[0].nodes[0].norm(), 0.05, 1e-12);
}

TEST(Ring, IsARegularLoopAroundAHole) {
  const TubeOptions options =
      read_tube("tube: {shape: ring, diameter_min: 0.08, diameter_max: 0.12, cylinder_count: 24}\n");
  Random random(2);
  for (const Tube& tube : generate_tubes(50, options, random)) {
    EXPECT_EQ(std::ranges::count(tube.node_degrees(), 2), 24);
    EXPECT_TRUE(is_connected(tube));
    const double radius = tube.nodes[0].norm();
    EXPECT_GE(radius, 0.04);
    EXPECT_LE(radius, 0.06);
    EXPECT_NEAR(tube.length(), 24 * 2 * radius * std::sin(std::numbers::pi / 24), 1e-12);
    const Vec3 normal = tube.nodes[0].cross(tube.nodes[1]).normalized();
    for (const Vec3& node : tube.nodes) EXPECT_NEAR(node.dot(normal), 0.0, 1e-12);
  }
  EXPECT_THAT(problem_with("tube: {shape: ring, diameter_min: 0.02}\n"), HasSubstr("leaves no hole"));
}

TEST(Ring, HasTheInertiaOfATorus) {
  const TubeOptions options =
      read_tube("tube: {shape: ring, radius: 0.01, diameter_min: 0.12, diameter_max: 0.12, cylinder_count: 120}\n");
  Random random(3);
  const Tube tube = generate_tubes(1, options, random).front();
  const MassProperties mass = mass_properties(tube);
  // A torus of radii c and a (e.g. Beer and Johnston): about its axis m (c^2 + 3/4 a^2), about a diameter
  // m (c^2 / 2 + 5/8 a^2).
  const double c = 0.06, a = 0.01;
  const Vec3 normal = tube.nodes[0].cross(tube.nodes[1]).normalized();
  const double along = tube.mass * (c * c + 0.75 * a * a), across = tube.mass * (c * c / 2 + 0.625 * a * a);
  EXPECT_NEAR(normal.dot(mass.inertia * normal), along, 2e-3 * along);
  EXPECT_NEAR(mass.inertia.trace(), along + 2 * across, 2e-3 * (along + 2 * across));
  EXPECT_NEAR(mass.center.norm(), 0.0, 1e-9);
}

TEST(Sphere, IsASolidOrHollowBall) {
  Random random(4);
  for (const double wall : {0.0, 0.004}) {
    const Tube tube =
        generate_tubes(1, read_tube(fmt::format("tube: {{shape: sphere, radius: 0.02, wall_thickness: {}}}\n", wall)),
                       random)
            .front();
    EXPECT_EQ(tube.nodes.size(), 1u);
    EXPECT_TRUE(tube.cylinders.empty());
    const double bore = wall > 0.0 ? 0.02 - wall : 0.0;
    const double expected =
        0.4 * tube.mass * (std::pow(0.02, 5) - std::pow(bore, 5)) / (std::pow(0.02, 3) - std::pow(bore, 3));
    EXPECT_LT((mass_properties(tube).inertia - expected * Eigen::Matrix3d::Identity()).norm(), 1e-9 * expected);
  }
}

/// The largest angle between consecutive cylinders over their length: a discrete curvature, 1/m.
double largest_curvature(const Tube& tube) {
  double largest = 0.0;
  for (std::size_t i = 2; i < tube.nodes.size(); ++i) {
    const Vec3 before = tube.nodes[i - 1] - tube.nodes[i - 2], after = tube.nodes[i] - tube.nodes[i - 1];
    largest = std::max(largest, angle_between(before, after) / (0.5 * (before.norm() + after.norm())));
  }
  return largest;
}

TEST(Curve, BendsSmoothlyAndNoTighterThanTheOptionsSay) {
  for (const char* form : {"arcs", "spline"}) {
    const TubeOptions options = read_tube(fmt::format(
        "tube: {{shape: curve, form: {}, radius: 0.036, length: 0.5, section_length_min: 0.05, bend_angle_min_deg: 30, "
        "bend_angle_max_deg: 60, cylinder_length_max: 0.002}}\n",
        form));
    Random random(5);
    double tightest = 0.0;
    for (const Tube& tube : generate_tubes(200, options, random)) {
      EXPECT_NEAR(tube.length(), 0.5, 1e-9);
      for (std::size_t i = 0; i < tube.cylinders.size(); ++i) {
        const bool is_end = i == 0 || i + 1 == tube.cylinders.size();
        EXPECT_LT(tube.length(tube.cylinders[i]), is_end ? 0.04 : 0.00205);
      }
      tightest = std::max(tightest, largest_curvature(tube));
    }
    const double bound = std::string(form) == "arcs" ? radians(60.0) / 0.05 : 1.0 / 0.036;
    EXPECT_LT(tightest, 1.03 * bound) << form;  // chords of arcs measure too much, the long ones at ends 2.3 %
    EXPECT_GT(tightest, 0.9 * bound) << form;   // and the options are used up
  }
}

/// How far a joint's sphere sticks out of a flat end, beyond its plane.
double closes_its_ends_by(const Tube& tube) {
  const std::vector<int> degrees = tube.node_degrees();
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t end = 0; end < degrees.size(); ++end) {
    if (degrees[end] != 1) continue;
    const Vec3 inward = tube.directions_from(static_cast<int>(end)).front();
    for (std::size_t i = 0; i < degrees.size(); ++i)
      if (degrees[i] > 1 && (tube.nodes[i] - tube.nodes[end]).norm() < 3.0 * tube.radius)
        most = std::max(most, tube.node_radii()[i] - inward.dot(tube.nodes[i] - tube.nodes[end]));
  }
  return most;
}

TEST(Curve, EndsFlat) {
  for (const char* form : {"arcs", "spline"}) {
    Random random(8);
    const TubeOptions options = read_tube(fmt::format("tube: {{shape: curve, form: {}, radius: 0.02}}\n", form));
    for (const Tube& tube : generate_tubes(200, options, random)) EXPECT_LE(closes_its_ends_by(tube), 0.0) << form;
  }
}

TEST(Curve, RadiusVariesSmoothlyWithinItsBounds) {
  const TubeOptions options = read_tube("tube: {shape: curve, radius: 0.01, radius_variation: 0.5, length: 0.6}\n");
  Random random(9);
  double thinnest = 1.0, thickest = 0.0;
  for (const Tube& tube : generate_tubes(200, options, random)) {
    for (std::size_t i = 0; i < tube.cylinders.size(); ++i) {
      const double radius = tube.cylinders[i].radius;
      thinnest = std::min(thinnest, radius);
      thickest = std::max(thickest, radius);
      // A smooth step over a section of 0.05 m or more is 1.5 times as steep as a straight one, 0.01 m over 0.05 m.
      if (i == 0) continue;
      const double apart = 0.5 * (tube.length(tube.cylinders[i]) + tube.length(tube.cylinders[i - 1]));
      EXPECT_LE(std::abs(radius - tube.cylinders[i - 1].radius), 1.5 * 0.01 / 0.05 * apart + 1e-12);
    }
    EXPECT_LE(closes_its_ends_by(tube), 0.0);
  }
  EXPECT_GE(thinnest, 0.005);
  EXPECT_LE(thickest, 0.015);
  EXPECT_LT(thinnest, 0.0055);
  EXPECT_GT(thickest, 0.0145);
  EXPECT_EQ(generate_tubes(1, read_tube("tube: {shape: curve}\n"), random).front().cylinders[3].radius, 0.0);
}

TEST(Curve, RefusesRadiiThatCannotBe) {
  EXPECT_THAT(problem_with("tube: {shape: curve, radius: 0.04, radius_variation: 0.5}\n"), HasSubstr("0.06 m"));
  EXPECT_THAT(problem_with("tube: {shape: curve, radius: 0.01, wall_thickness: 0.006, radius_variation: 0.5}\n"),
              HasSubstr("leaves no bore"));
}

TEST(HollowTubes, NeedEndsThatNoJointCloses) {
  EXPECT_THAT(problem_with("tube: {wall_thickness: 0.001, cylinder_length_min: 0.012}\n"), HasSubstr("close its ends"));
  EXPECT_EQ(problem_with("tube: {wall_thickness: 0.001, cylinder_length_min: 0.013}\n"), "");
  EXPECT_THAT(problem_with("tube: {shape: branching, wall_thickness: 0.001, paths: [{cylinder_length_min: 0.01}]}\n"),
              HasSubstr("tube.paths[0].cylinder_length_min"));
}

TEST(Curve, ArcsHaveConstantCurvature) {
  const TubeOptions options = read_tube(
      "tube: {shape: curve, length: 0.3, section_count_min: 1, section_count_max: 1, bend_angle_min_deg: 90, "
      "bend_angle_max_deg: 90, cylinder_length_max: 0.003}\n");
  Random random(6);
  const Tube tube = generate_tubes(1, options, random).front();
  // A quarter circle of length 0.3: its ends are sqrt(2) R apart.
  EXPECT_NEAR((tube.nodes.back() - tube.nodes.front()).norm(), std::numbers::sqrt2 * 0.3 / (std::numbers::pi / 2),
              1e-4);
  EXPECT_NEAR(largest_curvature(tube), std::numbers::pi / 2 / 0.3, 0.15);
}

TEST(Curve, RefusesBendsTighterThanTheTube) {
  EXPECT_THAT(problem_with("tube: {shape: curve, section_length_min: 0.019, bend_angle_max_deg: 90}\n"),
              HasSubstr("less than the tube's radius"));
  EXPECT_THAT(problem_with("tube: {shape: curve, section_count_max: 20}\n"), HasSubstr("more than the tube's length"));
}

std::vector<TubeKind> three_kinds() {
  std::vector<TubeKind> kinds(3);
  kinds[0].count = 2;
  kinds[0].radius = 0.01;
  kinds[0].name = "few";
  kinds[1].share = 3.0;
  kinds[1].radius = 0.02;
  kinds[2].share = 1.0;
  kinds[2].radius = 0.03;
  return kinds;
}

TEST(MixedKinds, HaveTheirCountsAndShares) {
  Random random(7);
  std::map<double, int> of_radius;
  int first_is_fixed = 0;
  for (int scene = 0; scene < 400; ++scene) {
    const std::vector<Tube> tubes = generate_mixed_tubes(10, three_kinds(), random);
    ASSERT_EQ(tubes.size(), 10u);
    EXPECT_EQ(std::ranges::count(tubes, 0.01, &Tube::radius), 2);
    for (const Tube& tube : tubes) ++of_radius[tube.radius];
    first_is_fixed += tubes.front().radius == 0.01;
    for (const Tube& tube : tubes)
      EXPECT_EQ(tube.kind, tube.radius == 0.01 ? "few" : tube.radius == 0.02 ? "chain_2" : "chain_3");
  }
  // 3200 draws with probability 3/4: mean 2400, standard deviation 24.5.
  EXPECT_NEAR(of_radius[0.02], 2400, 100);
  EXPECT_NEAR(first_is_fixed, 80, 32);  // a fifth of the scenes: 4 standard deviations
}

TEST(MixedKinds, RefuseNumbersThatCannotBe) {
  const KeyPlaces places;
  std::vector<TubeKind> kinds = three_kinds();
  EXPECT_NO_THROW(check(kinds, {2, 20}, places));
  EXPECT_THROW(check(kinds, {1}, places), ConfigError);
  kinds[1].name = "few";
  EXPECT_THROW(check(kinds, {2, 20}, places), ConfigError);
  kinds[1].name = "";
  kinds[1].share = kinds[2].share = 0.0;
  EXPECT_THROW(check(kinds, {2}, places), ConfigError);  // kinds that are never made
  kinds.resize(1);
  EXPECT_NO_THROW(check(kinds, {2}, places));
  EXPECT_THROW(check(kinds, {3}, places), ConfigError);
}

}  // namespace
}  // namespace tubebin::tube
