#include "tubebin/scene/tubes_txt.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/random.hpp"
#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::scene {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<PlacedTube> generated_tubes(int count) {
  Random random(11);
  std::vector<PlacedTube> placed;
  for (tube::Tube& tube : tube::generate_tubes(count, tube::TubeOptions{}, random))
    placed.push_back({std::move(tube), make_pose(random.rotation(), Vec3(random.uniform(-1, 1), 0.1, 0.2))});
  return placed;
}

void expect_same_in_world(const std::vector<PlacedTube>& actual, const std::vector<PlacedTube>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(actual[k].tube.radius, expected[k].tube.radius);
    EXPECT_EQ(actual[k].tube.cylinders, expected[k].tube.cylinders);
    ASSERT_EQ(actual[k].tube.nodes.size(), expected[k].tube.nodes.size());
    for (int i = 0; i < static_cast<int>(expected[k].tube.nodes.size()); ++i)
      EXPECT_EQ(actual[k].node_in_world(i), expected[k].node_in_world(i));
  }
}

/// An independent reading of the format with stream extraction; returns what is inconsistent.
std::string inconsistency(const std::string& text) {
  std::istringstream in(text);
  std::size_t tubes = 0;
  in >> tubes;
  for (std::size_t t = 0; t < tubes; ++t) {
    std::string id, a, b;
    int node_count = 0, edge_count = 0, order = 0;
    in >> id >> node_count >> edge_count;
    std::map<std::string, Vec3> nodes;
    double x, y, z, r, qw, qx, qy, qz, length;
    for (int i = 0; i < node_count; ++i) in >> id >> x >> y >> z >> r, nodes[id] = Vec3(x, y, z);
    for (int i = 0; i < edge_count; ++i) {
      in >> id >> a >> b >> order >> r >> x >> y >> z >> qw >> qx >> qy >> qz >> length;
      if (!in || !nodes.contains(a) || !nodes.contains(b)) return "edge " + id;
      const Vec3 half = Quat(qw, qx, qy, qz) * Vec3::UnitZ() * length / 2;
      if ((Vec3(x, y, z) - half - nodes[a]).norm() > 1e-9 || (Vec3(x, y, z) + half - nodes[b]).norm() > 1e-9)
        return "cylinder " + id;
    }
  }
  return in && (in >> std::ws).eof() ? "" : "end";
}

TEST(TubesTxt, ReadsBackTheSameAndCylindersAgreeWithNodes) {
  for (const int count : {1, 20}) {
    const std::vector<PlacedTube> tubes = generated_tubes(count);
    const std::string text = format_tubes_txt(tubes);
    EXPECT_EQ(inconsistency(text), "");
    expect_same_in_world(parse_tubes_txt(text, "a.txt"), tubes);
    EXPECT_EQ(format_tubes_txt(parse_tubes_txt(text, "a.txt")), text);
  }
}

TEST(TubesTxt, AxesAlongAndAgainstZAreWritten) {
  for (const double z : {0.5, -0.5}) {
    PlacedTube tube;
    tube.tube.radius = 0.01;
    tube.tube.nodes = {Vec3::Zero(), Vec3(0, 0, z)};
    tube.tube.cylinders = {{0, 1, 0}};
    EXPECT_EQ(inconsistency(format_tubes_txt({tube})), "") << z;
    expect_same_in_world(parse_tubes_txt(format_tubes_txt({tube}), "a.txt"), {tube});
  }
}

TEST(TubesTxt, NoTubesAreAScene) { EXPECT_TRUE(parse_tubes_txt(format_tubes_txt({}), "a.txt").empty()); }

TEST(TubesTxt, ReadsThePublishedScenesBranchingOnesToo) {
  if (!std::filesystem::exists(PUBLISHED_SCENES_DIR)) GTEST_SKIP() << "no published scenes in " PUBLISHED_SCENES_DIR;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PUBLISHED_SCENES_DIR)) {
    if (entry.path().extension() != ".txt") continue;
    SCOPED_TRACE(entry.path());
    ++files;
    const std::vector<PlacedTube> tubes = read_tubes_txt(entry.path().string());
    const std::string name = entry.path().stem().string();  // such as C10_1
    EXPECT_EQ(tubes.size(), std::stoul(name.substr(1)));
    for (const PlacedTube& tube : tubes) {
      EXPECT_EQ(tube.tube.radius, 0.0125);
      const bool branching = name[0] == 'C';
      EXPECT_EQ(tube.tube.nodes.size(), tube.tube.cylinders.size() + 1);
      const std::vector<int> degrees = tube.tube.node_degrees();
      EXPECT_EQ(std::count(degrees.begin(), degrees.end(), 1), branching ? 4 : 2);
      EXPECT_NEAR(tube.tube.length(), branching ? 0.75 : 0.5, 1e-4);
    }
    expect_same_in_world(parse_tubes_txt(format_tubes_txt(tubes), "again"), tubes);
  }
  EXPECT_EQ(files, 13);
}

constexpr const char* kTube =
    "1\n1 2 1\n"
    "1 0 0 0 0.01\n"
    "2 0 0 0.5 0.01\n"
    "e_1_2 1 2 1 0.01 0 0 0.25 1 0 0 0 0.5\n";

std::string text_error_of(const std::string& text) {
  try {
    parse_tubes_txt(text, "a.txt");
  } catch (const IoError& error) {
    return error.what();
  }
  return "no error";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(TubesTxt, RadiiAlongATubeReadBack) {
  tube::Tube tube{
      .radius = 0.01, .mass = 1.0, .nodes = {{0, 0, 0}, {0, 0, 0.1}, {0, 0, 0.2}, {0, 0, 0.3}}, .cylinders = {}};
  tube.cylinders = {{0, 1, 0, 0.012}, {1, 2, 1, 0.009}, {2, 3, 2, 0.0125}};
  const std::string text = format_tubes_txt({{tube, Pose::Identity()}});
  const tube::Tube back = parse_tubes_txt(text, "a.txt").front().tube;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(back.radius_of(back.cylinders[i]), tube.cylinders[i].radius);
  EXPECT_EQ(back.node_radii(), (std::vector<double>{0.012, 0.012, 0.0125, 0.0125}));
  EXPECT_EQ(format_tubes_txt({{back, Pose::Identity()}}), text);
  const std::string two = format_tubes_txt({{tube, Pose::Identity()}, {tube, Pose::Identity()}});
  EXPECT_EQ(format_tubes_txt(parse_tubes_txt(two, "a.txt")), two);
}

TEST(TubesTxt, ErrorsNameLineAndCause) {
  EXPECT_EQ(text_error_of(kTube), "no error");
  EXPECT_EQ(text_error_of(""), "a.txt: the file is empty; expected the number of tubes");
  EXPECT_EQ(text_error_of("ten\n"), "a.txt:1: 'ten' is not the number of tubes");
  EXPECT_EQ(text_error_of(replaced(kTube, "1\n", "2\n")),
            "a.txt: truncated after line 5: the first line says 2 tubes, but there are only 1");
  EXPECT_EQ(text_error_of(replaced(kTube, "1\n", "0\n")),
            "a.txt:2: the file's first line says 0 tubes, but there is more");
  EXPECT_THAT(text_error_of(replaced(kTube, "1 2 1\n", "1 4000000000 1\n")),
              HasSubstr("a.txt:5: found 13 values, expected a node line"));
  EXPECT_THAT(text_error_of(replaced(kTube, "1 2 1\n", "1 2 4000000000\n")),
              HasSubstr("a.txt: truncated after line 5: expected an edge line"));
  EXPECT_THAT(text_error_of(replaced(kTube, "1 2 1\n", "1 -2 1\n")), HasSubstr("a.txt:2: node count '-2'"));
  EXPECT_THAT(text_error_of(replaced(kTube, "2 0 0 0.5", "1 0 0 0.5")),
              HasSubstr("a.txt:4: the node id 1 stands twice"));
  EXPECT_THAT(text_error_of(replaced(kTube, "2 0 0 0.5", "2 0 nan 0.5")),
              HasSubstr("coordinate 'nan' is not a number"));
  EXPECT_THAT(text_error_of(replaced(kTube, "2 0 0 0.5 0.01", "2 0 0 0.5 0.02")),
              HasSubstr("node 2 has the radius 0.02, the thickest of its edges 0.01"));
  EXPECT_THAT(text_error_of(replaced(kTube, "1 0 0 0 0.01", "1 0 0 0 -1")),
              HasSubstr("a.txt:3: radius -1 is not valid"));
  EXPECT_THAT(text_error_of(replaced(kTube, "e_1_2 1 2", "e_1_2 1 3")),
              HasSubstr("a.txt:5: the edge names a node '3'"));
  EXPECT_THAT(text_error_of(replaced(kTube, "e_1_2 1 2", "e_1_2 1 1")), HasSubstr("at the same place"));
  EXPECT_THAT(text_error_of(replaced(kTube, "1 2 1 0.01", "1 2 0 0.01")), HasSubstr("order '0'"));
  EXPECT_THAT(text_error_of(replaced(kTube, "0 0 0.25", "0 0 0.26")), HasSubstr("the centre is 1.00e-02 m off"));
  EXPECT_THAT(text_error_of(replaced(kTube, "0 0.5\n", "0 0.6\n")), HasSubstr("length 0.6 is not the distance"));
  EXPECT_THAT(text_error_of(replaced(kTube, "0.25 1 0 0 0", "0.25 0 1 0 0")), HasSubstr("the axis is 2.00e+00 off"));
  EXPECT_THAT(text_error_of(replaced(replaced(kTube, "1 2 1\n", "1 3 1\n"), "2 0 0", "3 1 1 1 0.01\n2 0 0")),
              HasSubstr("no edge of this tube uses its node 3"));
}

TEST(TubesTxt, DamageIsSurvivedAndNamed) {
  Random random(5);
  const std::string whole = format_tubes_txt(generated_tubes(2));
  for (int round = 0; round < 3000; ++round) {
    std::string damaged = whole.substr(0, random.bits() % whole.size() + 1);
    for (int hit = random.integer(0, 3); hit > 0; --hit)
      damaged[random.bits() % damaged.size()] = static_cast<char>(random.integer(0, 255));
    const std::string error = text_error_of(damaged);
    if (error != "no error") {
      EXPECT_THAT(error, StartsWith("a.txt:"));
    }
  }
}

}  // namespace
}  // namespace tubebin::scene
