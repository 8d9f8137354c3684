// Data sets whose clouds are in the camera's frame or in millimetres, from generate_dataset to the measure.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/commands.hpp"
#include "support/program.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::testing {
namespace {

using ::testing::HasSubstr;

class CloudSpaces : public ::testing::Test {
 protected:
  void SetUp() override { make("world", "clean_cloud: true"); }

  /// Makes a data set of one scene, seen from the side.
  void make(const std::string& name, const std::string& output) {
    write_text(
        folder_ / "config.yaml",
        "set: Q\nseed: 5\ntubes: [4]\ncases: 1\n"
        "scanner: {width: 960, height: 600, horizontal_fov_deg: 35, position: [0.5, -0.7, 1.6], look_at: [0, 0, 0]}\n"
        "output: {" +
            output + "}\n");
    const ProgramResult made = run_generate_dataset({folder_ / "config.yaml", "--output", folder_ / name});
    ASSERT_EQ(made.exit_code, 0) << made.error;
  }
  std::string file(const std::string& name, const std::string& file) const {
    return folder_ / (name + "/Q4/001/" + file);
  }
  static ProgramResult run(const char* program, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), program_path(program));
    return Program(arguments).wait();
  }

  TemporaryFolder folder_;
};

/// Largest distance, metres, between the points of a file, brought to the world by hand, and those of the world's cloud.
double largest_distance(const cloud::Cloud& found, double unit, const Pose& world_from_file,
                        const cloud::Cloud& world) {
  EXPECT_EQ(found.size(), world.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < world.size(); ++i) {
    EXPECT_EQ(cloud::is_finite(found.points[i]), cloud::is_finite(world.points[i]));
    if (!cloud::is_finite(world.points[i])) continue;
    const Vec3 point = world_from_file * (unit * found.points[i].cast<double>());
    largest = std::max(largest, (point - world.points[i].cast<double>()).norm());
  }
  return largest;
}

TEST_F(CloudSpaces, HaveTheSamePointsAndTruth) {
  const cloud::Cloud world = cloud::read_cloud(file("world", "cloud.pcd"));
  const scene::SceneRecord truth = scene::read_scene_json(file("world", "scene.json"));
  const Pose camera = truth.scene.scanner.world_from_scanner();
  for (const auto& [format, is_camera] : {std::pair("ply_binary", false), std::pair("pcd_compressed", true)}) {
    fs::remove_all(folder_ / "data");
    make("data",
         fmt::format("clean_cloud: true, format: {}, unit: mm, frame: {}", format, is_camera ? "camera" : "world"));
    const std::string name = std::string("cloud") + (format[1] == 'l' ? ".ply" : ".pcd");
    const cloud::Cloud found = cloud::read_cloud(file("data", name));
    EXPECT_LT(largest_distance(found, 1e-3, is_camera ? camera : Pose::Identity(), world), 1e-6) << format;
    EXPECT_EQ(found.labels, world.labels);
    Pose viewpoint = is_camera ? Pose::Identity() : camera;
    viewpoint.translation() *= 1e3;
    EXPECT_TRUE(found.world_from_sensor.isApprox(viewpoint, 1e-5)) << format;
    const ProgramResult verified = run_generate_dataset({"--verify", folder_ / "data"});
    EXPECT_EQ(verified.exit_code, 0) << verified.out;
    scene::SceneRecord record = scene::read_scene_json(file("data", "scene.json"));
    EXPECT_EQ(record.space.unit, scene::CloudSpace::Unit::mm);
    record.space = {};
    EXPECT_EQ(scene::format_scene_json(record), read_text(file("world", "scene.json")));
  }
  expect_schema("scene.schema.json", file("data", "scene.json"));
}

TEST_F(CloudSpaces, AreModelledExportedAndScoredAsTheWorldsAre) {
  make("data", "frame: camera, unit: mm");
  std::map<std::string, nlohmann::json> recall;
  for (const std::string name : {"world", "data"}) {
    const ProgramResult modelled =
        run("model_tubes", {folder_ / name, "--output", folder_ / (name + "_results"), "--keep-clouds", "--quiet"});
    ASSERT_EQ(modelled.exit_code, 0) << modelled.error;
    const ProgramResult scored =
        run("evaluate", {folder_ / (name + "_results"), "--format", "json", "--html", folder_ / (name + ".html")});
    ASSERT_EQ(scored.exit_code, 0) << scored.error;
    recall[name] = nlohmann::json::parse(scored.out)["groups"][0]["micro_recall"];
  }
  EXPECT_NEAR(recall["data"].get<double>(), recall["world"].get<double>(), 0.005);
  EXPECT_GT(recall["world"].get<double>(), 0.95);
  for (const char* format : {"bop", "coco", "npz", "ply", "sdf"}) {
    const ProgramResult exported =
        run("export_dataset", {folder_ / "data", "--format", format, "--output", folder_ / format, "--quiet"});
    EXPECT_EQ(exported.exit_code, 0) << format << ": " << exported.error;
  }
}

TEST_F(CloudSpaces, ForeignProgramsAnswerInTheSpaceOfTheirInput) {
  make("data", "frame: camera, unit: mm");
  fs::create_directories(folder_ / "answers/Q4/001");
  fs::copy_file(file("data", "cloud.pcd"), folder_ / "answers/Q4/001/labeled.pcd");
  const ProgramResult scored =
      run("evaluate", {folder_ / "data", "--predictions", folder_ / "answers", "--format", "json"});
  ASSERT_EQ(scored.exit_code, 0) << scored.error;
  EXPECT_EQ(nlohmann::json::parse(scored.out)["groups"][0]["micro_recall"], 1.0);
}

TEST_F(CloudSpaces, ACloudAloneIsModelledInItsOwnFrame) {
  make("data", "frame: camera, unit: mm");
  fs::copy_file(file("data", "cloud.pcd"), folder_ / "alone.pcd");
  const ProgramResult alone =
      run("model_tubes", {folder_ / "alone.pcd", "--scale", "0.001", "--output", folder_ / "alone"});
  EXPECT_EQ(alone.exit_code, 0) << alone.error;
  EXPECT_THAT(alone.out, HasSubstr("4 tubes of radius 12.5"));
  // Beside its scene.json the unit is known, whether it is told or not.
  for (const std::vector<std::string>& told : {std::vector<std::string>{}, {"--scale", "0.001"}}) {
    std::vector<std::string> arguments = {file("data", "cloud.pcd"), "--output", folder_ / "model"};
    arguments.insert(arguments.end(), told.begin(), told.end());
    const ProgramResult modelled = run("model_tubes", arguments);
    EXPECT_EQ(modelled.exit_code, 0) << modelled.error;
    EXPECT_THAT(modelled.out, HasSubstr("4 tubes of radius 12.5"));
  }
}

}  // namespace
}  // namespace tubebin::testing
