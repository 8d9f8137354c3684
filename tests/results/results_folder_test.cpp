#include "tubebin/results/results_folder.hpp"

#include <gmock/gmock.h>

#include "support/synthetic_results.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/evaluation/result_tables.hpp"

namespace tubebin::results {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using testing::TemporaryFolder;
namespace fs = std::filesystem;

class ResultsFolder : public ::testing::Test {
 protected:
  void SetUp() override { testing::write_synthetic_sweep(folder_.path(), sweep_); }
  std::string results() const { return (folder_.path() / "results").string(); }
  fs::path run() const { return folder_.path() / "results" / "B2" / "001" / "centerline_0.3"; }
  std::string error() const {
    try {
      read_results({results()}, {});
    } catch (const IoError& e) {
      return e.what();
    }
    return "no error";
  }

  testing::SyntheticSweep sweep_;
  TemporaryFolder folder_;
};

TEST_F(ResultsFolder, EveryRunHasItsMicroRecall) {
  const evaluation::Evaluation evaluation = read_results({results()}, {"", 2, {}});
  ASSERT_THAT(evaluation.runs, SizeIs(24));
  EXPECT_THAT(evaluation.missing, IsEmpty());
  EXPECT_THAT(evaluation.notes, IsEmpty());
  for (const evaluation::RunScore& run : evaluation.runs) {
    EXPECT_DOUBLE_EQ(run.micro_recall, 1.0 - testing::wrong_points(run.key) / 1000.0) << run.key.name();
    EXPECT_DOUBLE_EQ(*run.seconds, testing::modelling_seconds(run.key));
    ASSERT_THAT(run.scores.tubes, SizeIs(run.key.tubes));
    EXPECT_NEAR(run.scores.tubes[0].centerline_error->model_mean, 0.0004, 1e-9);
    EXPECT_EQ(run.scores.tubes[0].visible_fraction, 1.0);
  }
}

TEST_F(ResultsFolder, ThreadsDoNotChangeTheResult) {
  EXPECT_EQ(evaluation::format_results(read_results({results()}, {"", 1, {}}), evaluation::TableFormat::json),
            evaluation::format_results(read_results({results()}, {"", 4, {}}), evaluation::TableFormat::json));
}

TEST_F(ResultsFolder, RunsThatAreNotThereYetAreNamed) {
  fs::remove_all(run());
  const evaluation::Evaluation evaluation = read_results({results()}, {});
  EXPECT_THAT(evaluation.runs, SizeIs(23));
  EXPECT_THAT(evaluation.missing, ElementsAre("B2/001 centerline 0.3"));
}

TEST_F(ResultsFolder, FailedRunsCountAsZero) {
  fs::remove_all(run());
  testing::write_text(folder_.path() / "results" / "failures.jsonl",
                      R"({"scene": "B2/001", "method": "centerline", "ratio": 0.3, "error": "no point in the bin"})"
                      "\n");
  const evaluation::Evaluation evaluation = read_results({results()}, {});
  EXPECT_THAT(evaluation.runs, SizeIs(24));
  EXPECT_THAT(evaluation.failed, ElementsAre("B2/001 centerline 0.3: no point in the bin"));
  for (const evaluation::RunScore& one : evaluation.runs)
    if (one.failed) {
      EXPECT_EQ(one.micro_recall, 0.0);
      EXPECT_EQ(one.scores.hoover.missed, 2);
    }
}

TEST_F(ResultsFolder, WithoutItsDataSetItSaysWhatCannotBeMeasured) {
  fs::rename(folder_.path() / "dataset", folder_.path() / "moved");
  const evaluation::Evaluation evaluation = read_results({results()}, {});
  EXPECT_THAT(evaluation.notes, ElementsAre(HasSubstr("12 of 12 scenes have no scene.json")));
  EXPECT_THAT(evaluation.runs.front().by_visibility, IsEmpty());
  const evaluation::Evaluation moved = read_results({results()}, {(folder_.path() / "moved").string(), 1, {}});
  EXPECT_THAT(moved.notes, IsEmpty());
}

TEST_F(ResultsFolder, DamagedFilesAreNamed) {
  const std::string good = read_file((run() / "result.json").string());
  fs::resize_file(run() / "result.json", good.size() / 2);
  EXPECT_THAT(error(), AllOf(HasSubstr("B2/001/centerline_0.3/result.json:"), HasSubstr("not valid JSON")));
  testing::write_text(run() / "result.json", "");
  EXPECT_THAT(error(), HasSubstr("the file is empty"));
  nlohmann::json json = nlohmann::json::parse(good);
  json["contingency"][0][2] = -4;
  testing::write_text(run() / "result.json", json.dump());
  EXPECT_THAT(error(), HasSubstr("result.json: /contingency/0/2: -4 is not valid"));
  json["contingency"][0][2] = 1;
  testing::write_text(run() / "result.json", json.dump());
  EXPECT_THAT(error(), HasSubstr("/filtered_points: 2000 is not valid"));
  json.erase("contingency");
  testing::write_text(run() / "result.json", json.dump());
  EXPECT_THAT(error(), HasSubstr("cannot be scored"));
  fs::remove(run() / "result.json");
  EXPECT_THAT(error(), HasSubstr("B2/001/centerline_0.3/result.json"));
}

TEST_F(ResultsFolder, FoldersThatAreNoResults) {
  for (const char* scene : {"A1", "A2", "A3", "B1", "B2", "B3"}) fs::remove_all(folder_.path() / "results" / scene);
  EXPECT_THAT(error(), HasSubstr("has none of the runs"));
  testing::write_text(folder_.path() / "results" / "index.json", "{}");
  EXPECT_THAT(error(), HasSubstr("index.json: /format: missing"));
  testing::write_text(folder_.path() / "results" / "index.json", "hello");
  EXPECT_THAT(error(), HasSubstr("index.json:1:1: not valid JSON"));
  fs::remove(folder_.path() / "results" / "index.json");
  EXPECT_THAT(error(), HasSubstr("has no index.json"));
  fs::remove_all(folder_.path() / "results");
  EXPECT_THAT(error(), HasSubstr("is no folder"));
}

TEST_F(ResultsFolder, GroupsAreMeansOverTheirCases) {
  const std::vector<evaluation::GroupSummary> groups = evaluation::summarize(read_results({results()}, {}).runs);
  ASSERT_THAT(groups, SizeIs(12));
  const evaluation::GroupSummary& first = groups.front();
  EXPECT_EQ(first.key, (evaluation::GroupKey{"centerline", "A", 1, 0.3}));
  EXPECT_EQ(first.runs, 2);
  EXPECT_NEAR(first.micro_recall.mean, 1.0 - (18.0 + 0.5) / 1000.0, 1e-12);
  EXPECT_NEAR(first.seconds->mean, 0.016, 1e-12);
  EXPECT_EQ(first.pooled.tubes, 2);
  EXPECT_NEAR(first.pooled.centerline_model_mean, 0.0004, 1e-9);
}

TEST_F(ResultsFolder, TablesHoldTheFigures) {
  const evaluation::Evaluation evaluation = read_results({results()}, {});
  const std::vector<evaluation::GroupSummary> groups = evaluation::summarize(evaluation.runs);
  const evaluation::Table by_tubes = evaluation::recall_by_tubes_table(groups, "centerline");
  EXPECT_THAT(by_tubes.headers, ElementsAre("tubes", "set A", "set B"));
  ASSERT_THAT(by_tubes.rows, SizeIs(3));
  EXPECT_NEAR(*by_tubes.rows[1][2].value, 1.0 - 26.5 / 1000.0, 1e-12);
  const evaluation::Table by_ratio = evaluation::recall_by_ratio_table(groups, "centerline");
  EXPECT_THAT(by_ratio.title, HasSubstr("3 tubes"));  // the nearest to ten
  EXPECT_THAT(by_ratio.rows, SizeIs(2));
  const evaluation::Table times = evaluation::time_grid(groups, "centerline", "B");
  EXPECT_THAT(times.headers, ElementsAre("ratio", "1", "2", "3"));
  EXPECT_DOUBLE_EQ(*times.rows[1][3].value, 0.07);
  EXPECT_THAT(evaluation::visibility_table(evaluation).rows, SizeIs(1));
  EXPECT_THAT(evaluation::group_table(groups).rows, SizeIs(12));
}

TEST_F(ResultsFolder, FormatsAgree) {
  const evaluation::Evaluation evaluation = read_results({results()}, {});
  const auto json = nlohmann::json::parse(evaluation::format_results(evaluation, evaluation::TableFormat::json));
  EXPECT_EQ(json["groups"].size(), 12U);
  const std::string csv = evaluation::format_results(evaluation, evaluation::TableFormat::csv);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 13);
  EXPECT_THAT(csv, HasSubstr(fmt::format("{}", json["groups"][0]["micro_recall"].get<double>())));
  EXPECT_THAT(evaluation::format_results(evaluation, evaluation::TableFormat::markdown),
              HasSubstr("| ratio | 1 | 2 | 3 |"));
}

TEST_F(ResultsFolder, ThePaperIsNamedWhereItIsAskedForAlone) {
  const evaluation::Evaluation evaluation = read_results({results()}, {});
  const evaluation::GenerationSeconds generation;
  for (const auto format : {evaluation::TableFormat::table, evaluation::TableFormat::markdown}) {
    const std::string general = evaluation::format_results(evaluation, format);
    for (const char* word : {"Figure", "(Table", "paper", "confirmed"})
      EXPECT_EQ(general.find(word), std::string::npos) << word;
    const std::string compared = evaluation::format_results(evaluation, format, &generation);
    for (const char* word : {"(Figure 8)", "(Figure 9)", "(Table 2)", "Claims of Section 6.2"})
      EXPECT_THAT(compared, HasSubstr(word));
  }
}

/// Another call of the same runs, with the radius estimated and the first scene better.
void write_estimated_results(const fs::path& folder) {
  fs::copy(folder / "results", folder / "estimated", fs::copy_options::recursive);
  nlohmann::json index = nlohmann::json::parse(read_file((folder / "estimated/index.json").string()));
  index["options"]["radius"] = 0.0;
  testing::write_text(folder / "estimated/index.json", index.dump());
  const fs::path run = folder / "estimated/A1/001/centerline_0.3/result.json";
  nlohmann::json result = nlohmann::json::parse(read_file(run.string()));
  result["contingency"] = {{1, 1, testing::kPointsPerTube}};
  testing::write_text(run, result.dump());
}

TEST_F(ResultsFolder, OtherOptionsStandSideBySide) {
  write_estimated_results(folder_.path());
  const std::vector<std::string> folders = {results(), (folder_.path() / "estimated").string()};
  const evaluation::Evaluation evaluation = read_results(folders, {});
  EXPECT_THAT(evaluation.runs, SizeIs(48));
  const auto json = nlohmann::json::parse(evaluation::format_results(evaluation, evaluation::TableFormat::json));
  ASSERT_THAT(json["side_by_side"], SizeIs(2));
  const nlohmann::json& set_a = json["side_by_side"][0];
  EXPECT_EQ(set_a["first"], "radius: 0.0125");
  EXPECT_EQ(set_a["second"], "radius: estimated");
  EXPECT_EQ(set_a["scenes"], 6);
  EXPECT_EQ(set_a["better"], 1);
  EXPECT_EQ(set_a["worse"], 0);
  // One of six scenes is right at one of two ratios.
  const double wrong = testing::wrong_points({"A1/001", "A", 1, 1, "centerline", 0.3}) / 1000.0;
  EXPECT_NEAR(set_a["gain"].get<double>(), wrong / 12.0, 1e-12);
  EXPECT_EQ(json["side_by_side"][1]["gain"], 0.0);
  EXPECT_THAT(evaluation::format_results(evaluation, evaluation::TableFormat::csv),
              AllOf(HasSubstr("radius: 0.0125,A,1,0.3"), HasSubstr("radius: estimated,A,1,0.3")));
}

TEST_F(ResultsFolder, SettingsHaveTheNamesThatAreGiven) {
  write_estimated_results(folder_.path());
  const std::vector<std::string> folders = {results(), (folder_.path() / "estimated").string()};
  ResultsOptions options;
  options.names = {"a", "b"};
  EXPECT_EQ(read_results(folders, options).runs.back().key.method, "b");
  options.names = {"a"};
  EXPECT_THROW(read_results(folders, options), ConfigError);
  options.names = {"a", "a"};
  EXPECT_THAT(
      [&] { read_results(folders, options); },
      ::testing::ThrowsMessage<IoError>(AllOf(HasSubstr("radius: 0.0125 and radius: estimated"), HasSubstr("--name"))));
}

TEST_F(ResultsFolder, EachCallThatLacksRunsIsNamed) {
  write_estimated_results(folder_.path());
  const std::string estimated = (folder_.path() / "estimated").string();
  fs::remove_all(estimated + "/B2/001");
  const evaluation::Evaluation evaluation = read_results({results(), estimated}, {});
  EXPECT_THAT(evaluation.missing, ElementsAre("B2/001 radius: estimated 0.3", "B2/001 radius: estimated 1"));
  EXPECT_THAT(evaluation.unfinished_calls, ElementsAre(ElementsAre(estimated)));
}

/// The columns that programs read (docs/metrics.md).
TEST_F(ResultsFolder, ColumnsOfGroupsStay) {
  const evaluation::Table table = evaluation::group_table(evaluation::summarize(read_results({results()}, {}).runs));
  EXPECT_THAT(table.headers,
              ElementsAre("method", "set", "tubes", "ratio", "runs", "failed", "micro_recall", "micro_recall_low",
                          "micro_recall_high", "seconds", "seconds_low", "seconds_high", "tube_recall",
                          "tube_precision", "tube_iou", "panoptic_quality", "ap50", "ap", "adjusted_rand_index",
                          "detected", "over_segmented", "under_segmented", "missed", "noise", "tube_count_error",
                          "tube_count_bias", "centerline_model_mean_m", "centerline_model_p95_m",
                          "centerline_truth_mean_m", "centerline_truth_p95_m"));
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.headers.size());
}

TEST(SceneName, TellsSetTubesAndCase) {
  const evaluation::RunKey key = evaluation::parse_scene_name("A10/007");
  EXPECT_EQ(key.set, "A");
  EXPECT_EQ(key.tubes, 10);
  EXPECT_EQ(key.case_number, 7);
  EXPECT_EQ(evaluation::parse_scene_name("my_bin_2/3").set, "my_bin_");
  EXPECT_EQ(evaluation::parse_scene_name("lab/left").set, "lab");
  EXPECT_EQ(evaluation::parse_scene_name("lab/left").tubes, 0);
  EXPECT_EQ(evaluation::parse_scene_name("42/1").set, "42");
}

}  // namespace
}  // namespace tubebin::results
