/// The program as a user runs it.
#include <gmock/gmock.h>

#include "support/commands.hpp"
#include "support/synthetic_results.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/tar.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin {
namespace {

using ::testing::AllOf;
using testing::CommandResult;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryFolder;
namespace fs = std::filesystem;

class EvaluateApp : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  /// Output and errors together, or the output alone.
  CommandResult evaluate(const std::string& arguments, const char* errors = "2>&1") const {
    return testing::run_command("cd '" + folder_.path().string() + "' && " + TUBEBIN_BIN_DIR + "/evaluate " +
                                arguments + " " + errors);
  }

  void write(const std::string& name, const std::vector<cloud::Point>& points, const std::vector<cloud::Label>& labels,
             const std::vector<cloud::Color>& colors = {}) const {
    cloud::Cloud cloud;
    cloud.points = points;
    cloud.labels = labels;
    cloud.colors = colors;
    cloud.width = static_cast<std::uint32_t>(points.size());
    cloud::write_cloud(path(name), cloud, cloud::CloudFormat::pcd_binary);
  }

  TemporaryFolder folder_;
  const std::vector<cloud::Point> points_ = {{0, 0, 0}, {0.1F, 0, 0}, {0.2F, 0, 0}, {0.3F, 0, 0}};
};

TEST_F(EvaluateApp, APairOfClouds) {
  write("filtered.pcd", points_, {1, 1, 2, 2});
  write("labeled.pcd", {points_[3], points_[0], points_[1]}, {7, 9, 9});
  const CommandResult result = evaluate("--filtered filtered.pcd --labeled labeled.pcd");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.output, HasSubstr("micro-recall 0.750000 = 3 / 4 points"));
  EXPECT_THAT(result.output, HasSubstr("1 points without a label (1 of them not in the labelled cloud)"));
  const auto json =
      nlohmann::json::parse(evaluate("--filtered filtered.pcd --labeled labeled.pcd --format json").output);
  EXPECT_EQ(json["micro_recall"], 0.75);
  EXPECT_EQ(json["matching"][1]["label"], "7");
}

TEST_F(EvaluateApp, PairsThatCannotBeScored) {
  write("filtered.pcd", points_, {1, 1, 2, 2});
  write("bare.pcd", points_, {});
  write("other.pcd", {{5, 5, 5}}, {1});
  testing::write_text(path("text.pcd"), "this is no cloud\n");
  const auto error = [&](const std::string& labeled) {
    const CommandResult result = evaluate("--filtered filtered.pcd --labeled " + labeled);
    EXPECT_EQ(result.exit_code, 1) << labeled;
    return result.output;
  };
  EXPECT_THAT(error("bare.pcd"), HasSubstr("bare.pcd: has neither a label field nor colours"));
  EXPECT_THAT(error("other.pcd"), HasSubstr("other.pcd: 1 of its 1 points are at no point of filtered.pcd"));
  EXPECT_THAT(error("text.pcd"), HasSubstr("text.pcd"));
  EXPECT_THAT(error("missing.pcd"), HasSubstr("missing.pcd"));
}

TEST_F(EvaluateApp, WrongUsageExitsWithTwo) {
  for (const char* arguments : {"", "--filtered a.pcd", "--labeled a.pcd", "results --format xml", "results --jobs 0",
                                "--predictions x", "results --nonsense", "results --filtered a --labeled b"})
    EXPECT_EQ(evaluate(arguments).exit_code, 2) << arguments;
  EXPECT_EQ(evaluate("--help").exit_code, 0);
}

TEST_F(EvaluateApp, AResultsFolder) {
  testing::write_synthetic_sweep(folder_.path(), {});
  const CommandResult result = evaluate("results");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("by number of tubes"), HasSubstr("by ratio"), Not(HasSubstr("Figure"))));
  EXPECT_NE(result.output.find("12/12 scenes"), std::string::npos);
  EXPECT_EQ(evaluate("results --format markdown --jobs 1", "2>/dev/null").output,
            evaluate("results --format markdown --jobs 3", "2>/dev/null").output);
}

TEST_F(EvaluateApp, ReportPlotsAndThePaper) {
  testing::write_synthetic_sweep(folder_.path(), {});
  const CommandResult result = evaluate("results --html report.html --plots plots --paper");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("Claims of Section 6.2, centerline"));
  EXPECT_THAT(read_file(path("report.html")), HasSubstr("</html>"));
  for (const char* plot : {"figure_8", "figure_9", "table_2_centerline"})
    EXPECT_THAT(read_file(path(std::string("plots/") + plot + ".svg")), HasSubstr("</svg>"));
  EXPECT_EQ(evaluate("results --plots general").exit_code, 0);
  for (const char* plot : {"recall_by_tubes", "recall_by_ratio", "seconds_by_tubes", "seconds_by_ratio"})
    EXPECT_THAT(read_file(path(std::string("general/") + plot + ".svg")), HasSubstr("</svg>"));
  EXPECT_EQ(evaluate("results --html nowhere/report.html").exit_code, 1);
  EXPECT_EQ(evaluate("results results").exit_code, 1);  // every run twice
}

TEST_F(EvaluateApp, AnUnfinishedResultsFolderExitsWithThree) {
  testing::write_synthetic_sweep(folder_.path(), {});
  fs::remove_all(folder_.path() / "results/A2/001");
  const CommandResult result = evaluate("results");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.output, AllOf(HasSubstr("2 runs are not there yet"), HasSubstr("A2/001 centerline 0.3")));
}

TEST_F(EvaluateApp, DamagedOrEmptyFoldersExitWithOne) {
  testing::write_synthetic_sweep(folder_.path(), {});
  testing::write_text(path("results/A2/001/centerline_0.3/model.json"), "{\"tubes\": [");
  EXPECT_EQ(evaluate("results").exit_code, 1);
  fs::create_directory(path("empty"));
  EXPECT_EQ(evaluate("empty").exit_code, 1);
  EXPECT_EQ(evaluate("nowhere").exit_code, 1);
}

/// A data set whose clouds the real scanner made.
void write_scanned_dataset(const fs::path& dataset, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    scene::SceneRecord record = testing::synthetic_scene(name, 3, 5);
    record.scene.scanner.width = 480;
    record.scene.scanner.height = 300;
    const scan::Scan scanned = scan::scan(record.scene);
    record.window = scanned.window;
    record.tube_pixels = scanned.tube_pixels;
    fs::create_directories(dataset / name);
    cloud::write_cloud((dataset / name / "cloud.pcd").string(), scanned.cloud, cloud::CloudFormat::pcd_binary);
    testing::write_text(dataset / name / "scene.json", scene::format_scene_json(record));
  }
}

TEST_F(EvaluateApp, PerfectPredictionsScoreOneAndMissingOnesZero) {
  write_scanned_dataset(folder_.path() / "dataset", {"A3/001", "A3/002"});
  fs::create_directories(folder_.path() / "mine/A3");
  fs::copy_file(path("dataset/A3/001/cloud.pcd"), path("mine/A3/001.pcd"));
  const CommandResult result = evaluate("dataset --predictions mine --format json", "2>/dev/null");
  EXPECT_EQ(result.exit_code, 3);
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json["missing"], nlohmann::json::array({"A3/002"}));
  EXPECT_EQ(json["groups"][0]["method"], "mine");
  EXPECT_DOUBLE_EQ(json["groups"][0]["micro_recall"], 0.5);
  EXPECT_DOUBLE_EQ(json["groups"][0]["missed"], 0.5);
  EXPECT_THAT(evaluate("dataset --predictions mine").output,
              AllOf(HasSubstr("1 scenes have no prediction and count as zero"), HasSubstr("A3/002")));
}

TEST_F(EvaluateApp, TwoProgramsStandSideBySide) {
  write_scanned_dataset(folder_.path() / "dataset", {"A3/001", "A3/002"});
  for (const char* scene : {"mine/A3/001.pcd", "yours/A3/001.pcd", "yours/A3/002.pcd"}) {
    fs::create_directories(fs::path(path(scene)).parent_path());
    fs::copy_file(path("dataset/A3/" + fs::path(scene).stem().string() + "/cloud.pcd"), path(scene));
  }
  const std::string both = "dataset --predictions mine --predictions yours --quiet ";
  const auto json = nlohmann::json::parse(evaluate(both + "--format json", "2>/dev/null").output);
  EXPECT_EQ(json["side_by_side"][0]["first"], "mine");
  EXPECT_EQ(json["side_by_side"][0]["second"], "yours");
  EXPECT_DOUBLE_EQ(json["side_by_side"][0]["gain"], 0.5);
  const CommandResult named = evaluate(both + "--name before --name after --html report.html");
  EXPECT_THAT(named.output, AllOf(HasSubstr("Side by side"), HasSubstr("before"), HasSubstr("+0.5000")));
  EXPECT_THAT(read_file(path("report.html")), HasSubstr("id=\"side_by_side\""));
  EXPECT_EQ(evaluate(both + "--name before").exit_code, 2);
  EXPECT_THAT(evaluate("dataset --predictions mine --predictions mine").output, HasSubstr("have one name: mine, mine"));
}

TEST_F(EvaluateApp, PredictionsThatFitNoScene) {
  write_scanned_dataset(folder_.path() / "dataset", {"A3/001"});
  fs::create_directory(path("empty"));
  EXPECT_THAT(evaluate("dataset --predictions empty").output, HasSubstr("expected empty/A3/001.pcd"));
  EXPECT_EQ(evaluate("dataset --predictions empty").exit_code, 1);
  EXPECT_EQ(evaluate("empty --predictions empty").exit_code, 1);
  fs::create_directories(path("wrong/A3"));
  write("wrong/A3/001.pcd", points_, {1, 1, 2, 2});
  const CommandResult result = evaluate("dataset --predictions wrong");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output,
              HasSubstr("wrong/A3/001.pcd: 4 of its 4 points are at no point of dataset/A3/001/cloud.pcd"));
}

/// The commands of the example: its program over a data set.
std::string kmeans(const std::string& python, const std::string& dataset, const std::string& labels) {
  return python + " -B " TUBEBIN_SOURCE_DIR "/examples/python/kmeans.py " + dataset + " " + labels + " 2>&1";
}

TEST(ForeignAlgorithms, ThePageShowsTheExample) {
  EXPECT_THAT(read_file(TUBEBIN_SOURCE_DIR "/docs/foreign_algorithms.md"),
              HasSubstr("```python\n" + read_file(TUBEBIN_SOURCE_DIR "/examples/python/kmeans.py") + "```"));
}

TEST_F(EvaluateApp, TheExampleOfAForeignAlgorithmIsScored) {
  const auto python = testing::find_python("numpy");
  if (!python) GTEST_SKIP() << "no python3 with numpy here";
  write_scanned_dataset(folder_.path() / "dataset", {"A3/001", "A3/002"});
  const CommandResult program = testing::run_command(kmeans(*python, path("dataset"), path("kmeans_labels")));
  ASSERT_EQ(program.exit_code, 0) << program.output;
  const CommandResult result = evaluate("dataset --predictions kmeans_labels --format json --quiet");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json["groups"][0]["method"], "kmeans_labels");
  EXPECT_GT(json["groups"][0]["micro_recall"],
            0.1);  // ten clusters over three tubes: each tube gets the largest cluster
  EXPECT_LT(json["groups"][0]["micro_recall"], 0.9);
  EXPECT_THAT(json["missing"], ::testing::IsEmpty());

  // The same from a pack.
  std::filesystem::create_directories(path("packed/packs"));
  std::string tar;
  for (const std::string scene : {"A3/001", "A3/002"})
    for (const std::string file : {"cloud.pcd", "scene.json"})
      tar += format_tar_member(scene + "." + file, read_file(path("dataset/" + scene + "/" + file)));
  testing::write_text(path("packed/packs/one.tar"), tar + format_tar_end());
  const CommandResult packed = testing::run_command(kmeans(*python, path("packed"), path("packed_labels")));
  ASSERT_EQ(packed.exit_code, 0) << packed.output;
  for (const std::string scene : {"A3/001", "A3/002"})
    EXPECT_EQ(read_file(path("packed_labels/" + scene + ".pcd")), read_file(path("kmeans_labels/" + scene + ".pcd")));
  EXPECT_EQ(evaluate("packed --predictions packed_labels").exit_code, 0);
}

}  // namespace
}  // namespace tubebin
