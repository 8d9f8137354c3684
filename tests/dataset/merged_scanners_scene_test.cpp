// Data sets of several scanners, as a user makes and uses them.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/commands.hpp"
#include "support/program.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string two_scanners(const std::string& more = "") {
  return "set: Q\nseed: 5\ntubes: [3]\ncases: 1\n"
         "scanners:\n"
         "  - {width: 640, height: 400}\n"
         "  - {width: 640, height: 400, position: [0.9, 0, 1.7], rotation_deg: [0, 28, 0], effects: {lateral_noise: 0.1}}\n" +
         more;
}

class MergedScanners : public ::testing::Test {
 protected:
  ProgramResult generate(const std::string& yaml) {
    write_text(folder_ / "config.yaml", yaml);
    return run_generate_dataset({folder_ / "config.yaml", "--output", folder_ / "data"});
  }
  TemporaryFolder folder_;
};

TEST_F(MergedScanners, AreVerifiedModelledAndEvaluated) {
  for (const char* format : {"pcd_binary", "pcd_compressed", "pcd_ascii", "ply_binary"}) {
    fs::remove_all(folder_ / "data");
    const ProgramResult made =
        generate(two_scanners(std::string("output: {clean_cloud: true, format: ") + format + "}\n"));
    ASSERT_EQ(made.exit_code, 0) << made.error;
    const ProgramResult verified = run_generate_dataset({"--verify", folder_ / "data"});
    EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.error;
  }
  const std::string scene = folder_ / "data/Q3/001";
  const scene::SceneRecord record = scene::read_scene_json(scene + "/scene.json");
  ASSERT_EQ(record.scene.further_scanners.size(), 1U);
  EXPECT_EQ(record.scene.further_scanners[0].position, Vec3(0.9, 0, 1.7));
  EXPECT_EQ(record.scene.further_scanners[0].effects.lateral_noise, 0.1);
  EXPECT_EQ(scene::format_scene_json(record), read_text(scene + "/scene.json"));
  const cloud::Cloud cloud = cloud::read_cloud(scene + "/cloud.ply");
  EXPECT_EQ(std::ranges::count(cloud.sources, 0U) + std::ranges::count(cloud.sources, 1U),
            static_cast<std::ptrdiff_t>(cloud.size()));
  EXPECT_GT(std::ranges::count(cloud.sources, 1U), 1000);

  expect_schema("scene.schema.json", scene + "/scene.json");

  const ProgramResult modelled = Program({program_path("model_tubes"), folder_ / "data", "--output",
                                          folder_ / "results", "--keep-clouds", "--quiet"})
                                     .wait();
  ASSERT_EQ(modelled.exit_code, 0) << modelled.error;
  const ProgramResult evaluated = Program({program_path("evaluate"), folder_ / "results", "--format", "json"}).wait();
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.error;
  EXPECT_GT(nlohmann::json::parse(evaluated.out)["groups"][0]["micro_recall"].get<double>(), 0.9);
  const cloud::Cloud filtered = cloud::read_cloud(folder_ / "results/Q3/001/centerline_1/filtered.pcd");
  EXPECT_EQ(filtered.sources.size(), filtered.size());
}

TEST_F(MergedScanners, AViewpointIsToldForEachSource) {
  ASSERT_EQ(generate(two_scanners()).exit_code, 0);
  fs::copy_file(folder_ / "data/Q3/001/cloud.pcd", folder_ / "alone.pcd");
  const auto model = [&](std::vector<std::string> viewpoints) {
    std::vector<std::string> command = {program_path("model_tubes")};
    for (const std::string& viewpoint : viewpoints) command.insert(command.end(), {"--viewpoint", viewpoint});
    command.insert(command.end(), {folder_ / "alone.pcd", "--output", folder_ / "model"});
    return Program(command).wait();
  };
  const ProgramResult told = model({"0,0,2", "0.9,0,1.7"});
  EXPECT_THAT(told.out, HasSubstr("3 tubes of radius")) << told.error;
  EXPECT_THAT(told.out, HasSubstr("viewpoint (0.000, 0.000, 2.000), (0.900, 0.000, 1.700)"));
  expect_schema("model.schema.json", folder_ / "model/model.json");
  EXPECT_THAT(model({"0,0,2"}).error, HasSubstr("has 2 sources, and the viewpoints of 1 are told"));
  EXPECT_THAT(model({}).error, HasSubstr("2 sources and the viewpoint of one"));
  cloud::Cloud cloud = cloud::read_cloud(folder_ / "alone.pcd");
  cloud.sources.clear();
  cloud::write_cloud(folder_ / "alone.pcd", cloud, cloud::CloudFormat::pcd_binary);
  EXPECT_THAT(model({"0,0,2", "0.9,0,1.7"}).error, HasSubstr("has no field source, and 2 viewpoints are told"));
}

TEST_F(MergedScanners, ExportsShowTheFirstScannersImage) {
  ASSERT_EQ(generate(two_scanners()).exit_code, 0);
  for (const char* format : {"bop", "coco", "npz", "ply", "sdf"}) {
    const ProgramResult exported = Program({program_path("export_dataset"), folder_ / "data", "--format", format,
                                            "--output", folder_ / format, "--quiet"})
                                       .wait();
    EXPECT_EQ(exported.exit_code, 0) << format << ": " << exported.error;
  }
}

TEST_F(MergedScanners, ElementsTakeWhatTheyLeaveOutFromAnIncludedScanner) {
  write_text(folder_ / "base.yaml", "set: Q\nseed: 5\ntubes: [1]\ncases: 1\nscanner: {width: 320, height: 200}\n");
  const ProgramResult made = generate("include: base.yaml\nscanners:\n  - {}\n  - {position: [0.1, 0, 2]}\n");
  ASSERT_EQ(made.exit_code, 0) << made.error;
  const scene::SceneRecord record = scene::read_scene_json(folder_ / "data/Q1/001/scene.json");
  EXPECT_EQ(record.scene.scanner.width, 320);
  EXPECT_EQ(record.scene.further_scanners.at(0).width, 320);
}

TEST_F(MergedScanners, WhatCannotBeIsNamedWithItsPlace) {
  EXPECT_THAT(generate("scanners:\n  - {range_min: 3}\n").error, HasSubstr("scanners[0].range_max"));
  EXPECT_THAT(generate("scanners:\n  - {}\nscanner: {width: 320}\n").error,
              AllOf(HasSubstr("config.yaml:3"), HasSubstr("scanner")));
  EXPECT_THAT(generate("scanners:\n  - {wide: 3}\n").error, HasSubstr("config.yaml:2"));
}

}  // namespace
}  // namespace tubebin::testing
