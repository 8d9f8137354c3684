// export_dataset as a user runs it. What it writes is compared with the data set by tests/export/check_export.py, through
// the formats' own readers where they are installed.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/program.hpp"

namespace tubebin::testing {
namespace {

using ::testing::HasSubstr;

constexpr int kPackageMissing = 77;

ProgramResult run_export(const std::string& dataset, const std::string& format, const std::string& output) {
  return Program({program_path("export_dataset"), dataset, "--format", format, "--output", output, "--jobs", "2"})
      .wait();
}

ProgramResult run_python(const std::string& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"/usr/bin/env", "-C", folder, "python3"});
  return Program(arguments).wait();
}

/// The data set that all tests of this file export.
class ExportDataset : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    make_dataset(1);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::string in_folder(const std::string& name) { return *folder_ / name; }
  static std::string dataset() { return in_folder("dataset"); }

  static void make_dataset(int cases) {
    const std::string config = in_folder("config.yaml");
    write_text(config, quick_config());
    const ProgramResult made =
        run_generate_dataset({config, "--output", dataset(), "--cases", std::to_string(cases), "--quiet"});
    ASSERT_EQ(made.exit_code, 0) << made.error;
  }

  /// Exports, and compares by check_export.py, where Python has what that needs.
  void expect_agreement(const std::string& format, std::vector<std::string> more = {}) {
    expect_agreement_of(dataset(), format, {}, std::move(more));
  }
  void expect_agreement_of(const std::string& data, const std::string& format, const std::vector<std::string>& options,
                           std::vector<std::string> more = {}) {
    const std::string output = data + "_as_" + format + (options.empty() ? "" : options.front());
    std::vector<std::string> command = {program_path("export_dataset"), data, "--format", format, "--output", output};
    command.insert(command.end(), options.begin(), options.end());
    const ProgramResult exported = Program(command).wait();
    ASSERT_EQ(exported.exit_code, 0) << exported.error;
    more.insert(more.begin(), {TUBEBIN_SOURCE_DIR "/tests/export/check_export.py", format, data, output});
    const ProgramResult checked = run_python(in_folder(""), more);
    if (checked.exit_code == kPackageMissing) GTEST_SKIP() << "python3: " << checked.out;
    EXPECT_EQ(checked.exit_code, 0) << checked.error << checked.out;
  }

  static std::unique_ptr<TemporaryFolder> folder_;
};
std::unique_ptr<TemporaryFolder> ExportDataset::folder_;

TEST_F(ExportDataset, BopHasTheScenesAsItsDefinitionSays) { expect_agreement("bop"); }
/// Balls, rings, straight and bent tubes, with a bore and without, in one bin.
std::string kinds_config() {
  return "set: K\nseed: 7\ntubes: [7]\ncases: 2\nscanner: {width: 480, height: 300}\nkinds:\n"
         "  - {name: ball, count: 2, shape: sphere, radius: 0.02}\n"
         "  - {name: ring, count: 1, shape: ring, radius: 0.008}\n"
         "  - {name: rod, count: 2, shape: chain, length: 0.2, cylinder_count_min: 1, cylinder_count_max: 1}\n"
         "  - {name: pipe, count: 2, shape: chain, length: 0.2, cylinder_count_max: 6, wall_thickness: 0.002}\n";
}

TEST_F(ExportDataset, KindsAreObjectsCategoriesAndNames) {
  write_text(in_folder("kinds.yaml"), kinds_config());
  const std::string kinds = in_folder("kinds");
  const ProgramResult made = run_generate_dataset({in_folder("kinds.yaml"), "--output", kinds, "--quiet"});
  ASSERT_EQ(made.exit_code, 0) << made.error;
  expect_agreement_of(kinds, "bop", {});
  expect_agreement_of(kinds, "bop", {"--crop"}, {"crop"});
  expect_agreement_of(kinds, "coco", {});
  expect_agreement_of(kinds, "npz", {"--normals"});
  expect_agreement_of(kinds, "sdf", {});
}

TEST_F(ExportDataset, HasWhatStandsAroundTheBin) {
  write_text(in_folder("cell.yaml"),
             "set: S\nseed: 5\ntubes: [3]\ncases: 2\n"
             "surroundings: {table: {length: 1.9, width: 1.5}, boxes: {count_min: 2, count_max: 2}, "
             "cylinders: {count_min: 2, count_max: 2}, bins: 1}\n"
             "scanner: {position: [0, -0.8, 1.4], rotation_deg: [30, 0, 0], width: 320, height: 240, region: full}\n");
  const std::string cell = in_folder("cell");
  const ProgramResult made = run_generate_dataset({in_folder("cell.yaml"), "--output", cell, "--quiet"});
  ASSERT_EQ(made.exit_code, 0) << made.error;
  expect_agreement_of(cell, "bop", {"--crop"}, {"crop"});
  expect_agreement_of(cell, "npz", {"--normals"});
  expect_agreement_of(cell, "sdf", {});
}

TEST_F(ExportDataset, RefusesWhatAFormatLacks) {
  const auto refused = [&](const std::string& format, const std::string& option) {
    return Program(
               {program_path("export_dataset"), dataset(), "--format", format, option, "--output", in_folder("never")})
        .wait();
  };
  EXPECT_EQ(refused("npz", "--crop").exit_code, 2);
  EXPECT_THAT(refused("npz", "--crop").error, HasSubstr("--crop: npz has no images"));
  EXPECT_THAT(refused("bop", "--normals").error, HasSubstr("--normals: bop has none"));
}

TEST_F(ExportDataset, CocoIsWhatPycocotoolsLoads) { expect_agreement("coco"); }
TEST_F(ExportDataset, NpzIsWhatNumpyLoads) { expect_agreement("npz"); }
TEST_F(ExportDataset, PlyHasTheTubesPoints) { expect_agreement("ply"); }
TEST_F(ExportDataset, SdfHasTheStructureOfPublishedWorldsAndTheTubesPlaces) {
  std::vector<std::string> published;
  if (fs::exists(PUBLISHED_SCENES_DIR))
    for (const fs::directory_entry& entry : fs::directory_iterator(PUBLISHED_SCENES_DIR))
      if (entry.path().extension() == ".world") published.push_back(entry.path().string());
  expect_agreement("sdf", published);
}

TEST_F(ExportDataset, TheGuidesExamplesRun) {
  for (const std::string format : {"bop", "coco", "npz", "ply", "sdf"})
    ASSERT_EQ(run_export(TUBEBIN_SOURCE_DIR "/data", format, in_folder("exported_" + format)).exit_code, 0);
  fs::create_directory(in_folder("pictures"));
  const ProgramResult ran = run_python(in_folder(""), {TUBEBIN_SOURCE_DIR "/tests/export/run_page.py",
                                                       TUBEBIN_SOURCE_DIR "/docs/export_formats.md", "pictures"});
  if (ran.exit_code == kPackageMissing) GTEST_SKIP() << "python3: " << ran.out;
  EXPECT_EQ(ran.exit_code, 0) << ran.error;
}

TEST_F(ExportDataset, MasksAndCountsAgreeInBopAndCocoWithoutPython) {
  ASSERT_EQ(run_export(dataset(), "bop", in_folder("b")).exit_code, 0);
  ASSERT_EQ(run_export(dataset(), "coco", in_folder("c")).exit_code, 0);
  using nlohmann::json;
  const json index = json::parse(read_text(in_folder("b") + "/index.json"));
  const json coco = json::parse(read_text(in_folder("c") + "/annotations.json"));
  ASSERT_EQ(index["scenes"].size(), 2U);
  ASSERT_EQ(coco["images"].size(), 2U);
  EXPECT_EQ(coco["images"][1]["width"], 320);
  std::size_t annotation = 0;
  for (std::size_t scene = 0; scene < 2; ++scene) {
    const std::string name = index["scenes"][scene]["scene"];
    const json truth = json::parse(read_text(dataset() + "/" + name + "/scene.json"));
    const json infos =
        json::parse(read_text(in_folder("b") + "/test/00000" + std::to_string(scene + 1) + "/scene_gt_info.json"));
    for (std::size_t k = 0; k < truth["tubes"].size(); ++k) {
      EXPECT_EQ(infos["0"][k]["px_count_all"], truth["tubes"][k]["amodal_pixels"]);
      EXPECT_EQ(infos["0"][k]["px_count_visib"], truth["tubes"][k]["visible_pixels"]);
      if (truth["tubes"][k]["visible_pixels"] == 0) continue;
      const json& counts = coco["annotations"][annotation]["segmentation"]["counts"];
      std::size_t inside = 0, all = 0;
      for (std::size_t i = 0; i < counts.size(); ++i) {
        inside += i % 2 == 1 ? counts[i].get<std::size_t>() : 0;
        all += counts[i].get<std::size_t>();
      }
      EXPECT_EQ(inside, truth["tubes"][k]["visible_pixels"].get<std::size_t>());
      EXPECT_EQ(all, 320U * 200U);
      ++annotation;
    }
  }
  EXPECT_EQ(annotation, coco["annotations"].size());
}

TEST_F(ExportDataset, GoesOnWithWhatIsMissingAndKeepsNumbersWhenTheDataSetGrows) {
  const std::string output = in_folder("growing");
  ASSERT_EQ(run_export(dataset(), "bop", output).exit_code, 0);
  const auto before = scene_files(output);
  fs::remove_all(output + "/test/000002");
  fs::create_directories(output + "/test/.000002.partial/mask");
  const ProgramResult again = run_export(dataset(), "bop", output);
  EXPECT_EQ(again.exit_code, 0) << again.error;
  EXPECT_THAT(again.out, HasSubstr("2 scenes, 1 exported"));
  EXPECT_EQ(scene_files(output), before);

  make_dataset(2);
  ASSERT_EQ(run_export(dataset(), "bop", output).exit_code, 0);
  const auto after = scene_files(output);
  for (const auto& [name, bytes] : before) {
    const bool is_summary = name.starts_with("models") && name.ends_with("/models_info.json");
    EXPECT_TRUE(is_summary || after.at(name) == bytes) << name;
  }
  EXPECT_TRUE(after.contains("test/000004/scene_gt.json"));
}

TEST_F(ExportDataset, ABrokenSceneIsNamedAndTheOthersAreExported) {
  const std::string broken = in_folder("broken");
  fs::copy(dataset(), broken, fs::copy_options::recursive);
  fs::resize_file(broken + "/Q3/001/cloud.pcd", 5000);
  const ProgramResult result = run_export(broken, "npz", in_folder("of_broken"));
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.error, HasSubstr("Q3/001"));
  EXPECT_TRUE(fs::exists(in_folder("of_broken") + "/Q1/001.npz"));
  EXPECT_FALSE(fs::exists(in_folder("of_broken") + "/Q3/001.npz"));
}

TEST_F(ExportDataset, WhatCannotBeMeantIsRefused) {
  const auto expect_refusal = [&](const ProgramResult& result, int exit_code, const std::string& why) {
    EXPECT_EQ(result.exit_code, exit_code);
    EXPECT_THAT(result.error, HasSubstr(why));
  };
  const std::string output = in_folder("once");
  ASSERT_EQ(run_export(dataset(), "npz", output).exit_code, 0);
  expect_refusal(run_export(dataset(), "ply", output), 2, "this export has export npz, not ply");
  expect_refusal(run_export(TUBEBIN_SOURCE_DIR "/data", "npz", output), 2, "was made from another data set");
  expect_refusal(run_export(dataset(), "zip", in_folder("never")), 2, "bop,coco,npz,ply,sdf");
  expect_refusal(run_export(in_folder("nothing"), "npz", in_folder("never")), 1, "not a folder");
  expect_refusal(run_export(TUBEBIN_SOURCE_DIR "/docs", "npz", in_folder("never")), 1, "holds no cloud.pcd");
  expect_refusal(run_export(dataset() + "/Q1/001", "npz", in_folder("never")), 1, "is a single scene");
  fs::create_directory(in_folder("foreign"));
  write_text(in_folder("foreign") + "/letter.txt", "Dear reader");
  expect_refusal(run_export(dataset(), "npz", in_folder("foreign")), 2, "no export");
  EXPECT_FALSE(fs::exists(in_folder("foreign") + "/.lock"));
  EXPECT_FALSE(fs::exists(in_folder("never")));
  EXPECT_EQ(Program({program_path("export_dataset"), dataset()}).wait().exit_code, 2);
}

TEST_F(ExportDataset, TheDemoDataAndScansOfTubesAloneCanBeExported) {
  for (const std::string format : {"bop", "coco", "npz", "ply", "sdf"})
    EXPECT_EQ(run_export(TUBEBIN_SOURCE_DIR "/data", format, in_folder("demo_" + format)).exit_code, 0) << format;

  std::string config = quick_config();
  config.replace(config.find("height: 200"), 11, "height: 200, region: tubes");
  write_text(in_folder("tubes.yaml"), config);
  ASSERT_EQ(run_generate_dataset({in_folder("tubes.yaml"), "--output", in_folder("tubes"), "--cases", "1", "--quiet"})
                .exit_code,
            0);
  ASSERT_EQ(run_export(in_folder("tubes"), "bop", in_folder("tubes_bop")).exit_code, 0);
  using nlohmann::json;
  const json truth = json::parse(read_text(in_folder("tubes") + "/Q3/001/scene.json"));
  const json infos = json::parse(read_text(in_folder("tubes_bop") + "/test/000002/scene_gt_info.json"))["0"];
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(infos[k]["px_count_visib"], truth["tubes"][k]["visible_pixels"]);
}

}  // namespace
}  // namespace tubebin::testing
