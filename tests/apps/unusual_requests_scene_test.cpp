// Requests that are unusual but right: each gives scenes that are what was asked for, pass --verify and can be modelled,
// or is refused with its reason.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "support/program.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/dataset/dataset_config.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct Request {
  const char* name;
  const char* config;
  const char* reason = nullptr;  ///< where it is refused
};

std::ostream& operator<<(std::ostream& out, const Request& request) { return out << request.name; }
std::string name_of(const ::testing::TestParamInfo<Request>& info) { return info.param.name; }

double bend_deg(const tube::Tube& tube, std::size_t joint) {
  const Vec3 before = tube.nodes[joint] - tube.nodes[joint - 1], after = tube.nodes[joint + 1] - tube.nodes[joint];
  return std::atan2(before.cross(after).norm(), before.dot(after)) * 180.0 / M_PI;
}

void expect_tube_as_asked(const tube::Tube& tube, const tube::TubeOptions& asked) {
  EXPECT_EQ(tube.radius, asked.radius);
  EXPECT_NEAR(tube.length(), asked.length, 1e-9);
  EXPECT_GE(tube.cylinders.size(), static_cast<std::size_t>(asked.cylinder_count_min));
  EXPECT_LE(tube.cylinders.size(), static_cast<std::size_t>(asked.cylinder_count_max));
  for (const tube::Cylinder& cylinder : tube.cylinders)
    EXPECT_GE(tube.length(cylinder), asked.cylinder_length_min - 1e-9);
  for (std::size_t joint = 1; joint + 1 < tube.nodes.size(); ++joint) {
    EXPECT_GE(bend_deg(tube, joint), asked.bend_angle_min_deg - 1e-6);
    EXPECT_LE(bend_deg(tube, joint), asked.bend_angle_max_deg + 1e-6);
  }
}

class UnusualRequest : public ::testing::TestWithParam<Request> {
 protected:
  ProgramResult generate() {
    write_text(config_, GetParam().config);
    return run_generate_dataset({config_, "--output", data_});
  }

  TemporaryFolder folder_;
  std::string config_ = folder_ / "unusual.yaml";
  std::string data_ = folder_ / "data";
};

using Granted = UnusualRequest;

TEST_P(Granted, GivesWhatWasAskedFor) {
  const ProgramResult result = generate();
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_EQ(run_generate_dataset({"--verify", data_}).exit_code, 0);

  const dataset::DatasetConfig config = dataset::load_config(config_);
  const dataset::Manifest manifest(data_);
  EXPECT_EQ(manifest.records().size(), config.tubes.size() * static_cast<std::size_t>(config.cases));
  for (const auto& [id, record] : manifest.records()) {
    const scene::SceneRecord scene = scene::read_scene_json(data_ + "/" + id + "/scene.json");
    EXPECT_EQ(scene.scene.tubes.size(), static_cast<std::size_t>(config.tubes.front()));
    for (const scene::PlacedTube& placed : scene.scene.tubes) expect_tube_as_asked(placed.tube, config.tube);
    const cloud::Cloud cloud = cloud::read_cloud(data_ + "/" + id + "/cloud.pcd");
    EXPECT_EQ(cloud.width, static_cast<std::uint32_t>(scene.window.width));
    EXPECT_EQ(cloud.height, static_cast<std::uint32_t>(scene.window.height));
    EXPECT_TRUE(std::any_of(cloud.points.begin(), cloud.points.end(), cloud::is_finite));
  }

  const std::string results = folder_ / "results";
  const ProgramResult modelled = Program({program_path("model_tubes"), data_, "--output", results}).wait();
  EXPECT_EQ(modelled.exit_code, 0) << modelled.error;
  const ProgramResult evaluated = Program({program_path("evaluate"), results}).wait();
  EXPECT_EQ(evaluated.exit_code, 0) << evaluated.error;
}

constexpr Request kGranted[] = {
    {"OneTubeOfOneCylinder", "{tubes: [1], cases: 2, tube: {cylinder_count_min: 1, cylinder_count_max: 1}}"},
    {"TwoCylindersAtTheirShortest",
     "{tubes: [3], cases: 2, tube: {length: 0.04, cylinder_length_min: 0.02, cylinder_count_min: 2, "
     "cylinder_count_max: 2}}"},
    {"TwoHundredTubesInALargeBin",
     "{tubes: [200], cases: 1, tube: {radius: 0.006, length: 0.2, cylinder_count_max: 6}, "
     "bin: {length: 1.2, width: 0.8, height: 0.4}, scanner: {width: 640, height: 400}}"},
    {"RadiusOfTwoMillimetres", "{tubes: [5], cases: 1, tube: {radius: 0.002}}"},
    {"LengthOfTwoMetres",
     "{tubes: [3], cases: 1, tube: {length: 2.0}, bin: {length: 2.2, width: 1.0, height: 0.4}, "
     "scanner: {width: 640, height: 400}}"},
    {"StraightTubes", "{tubes: [5], cases: 1, tube: {bend_angle_max_deg: 0}}"},
    {"BendsOf120Degrees",
     "{tubes: [3], cases: 1, tube: {bend_angle_min_deg: 120, bend_angle_max_deg: 120, cylinder_length_min: 0.05, "
     "cylinder_count_min: 2, cylinder_count_max: 5}}"},
    {"BendsUpTo120Degrees", "{tubes: [3], cases: 1, tube: {bend_angle_max_deg: 120}}"},
    {"TiltedScanner", "{tubes: [5], cases: 1, scanner: {position: [0, -0.8, 1.6], rotation_deg: [27, 0, 0]}}"},
    {"ScannerTurnedAboutAllAxes",
     "{tubes: [2], cases: 1, scanner: {position: [0.5, 0.3, 1.5], rotation_deg: [10, -20, 30]}}"},
    {"ScannerInsideTheFieldOfTubes",
     "{tubes: [20], cases: 1, scanner: {position: [0, 0, 0.05], range_min: 0.001, width: 320, height: 200}}"},
    {"FewPixels", "{tubes: [5], cases: 1, scanner: {width: 64, height: 40}}"},
    {"ManyPixels", "{tubes: [5], cases: 1, scanner: {width: 4096, height: 3000}}"},
    {"NoFriction", "{tubes: [2], cases: 1, physics: {friction_tube: 0, friction_bin: 0}}"},
};
INSTANTIATE_TEST_SUITE_P(, Granted, ::testing::ValuesIn(kGranted), name_of);

using Refused = UnusualRequest;

TEST_P(Refused, SaysWhy) {
  const ProgramResult result = generate();
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.error, AllOf(HasSubstr("given up after 50 attempts"), HasSubstr(GetParam().reason)));
  EXPECT_EQ(dataset::Manifest(data_).records().size(), 0u);
}

constexpr Request kRefused[] = {
    {"BinSmallerThanTheTube", "{tubes: [2], cases: 1, bin: {length: 0.1, width: 0.1, height: 0.05}}", "left the bin"},
    {"ScannerThatLooksAway", "{tubes: [1], cases: 1, scanner: {rotation_deg: [180, 0, 0]}}", "the cloud has no point"},
    {"ScannerNearerThanItsRange", "{tubes: [1], cases: 1, scanner: {position: [0, 0, 0.05]}}", "range_min 0.1 m"},
};
INSTANTIATE_TEST_SUITE_P(, Refused, ::testing::ValuesIn(kRefused), name_of);

}  // namespace
}  // namespace tubebin::testing
