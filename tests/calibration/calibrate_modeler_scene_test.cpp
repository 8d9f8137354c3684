// calibrate_modeler as a user runs it: what it writes, that others find the same figures, bad input, interruptions.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "calibration/calibration_trials.hpp"
#include "support/faults.hpp"
#include "tubebin/calibration/calibration.hpp"
#include "tubebin/results/results_folder.hpp"

namespace tubebin::testing {

using namespace calibration;
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class CalibrateModeler : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    write_text(*folder_ / "quick.yaml",
               "set: Q\nseed: 5\ntubes: [1, 3]\ncases: 4\nscanner: {width: 640, height: 400}\n");
    ASSERT_EQ(run_generate_dataset({*folder_ / "quick.yaml", "--output", dataset()}).exit_code, 0);
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string dataset() { return *folder_ / "dataset"; }
  static std::string file(const std::string& name) { return *folder_ / name; }

  static std::vector<std::string> command(const std::string& output) {
    return {program_path("calibrate_modeler"), dataset(), "--output", output, "--budget", "4", "--jobs", "2"};
  }
  static ProgramResult run(std::vector<std::string> arguments, const std::vector<std::string>& more = {}) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Program(arguments).wait();
  }

  static std::unique_ptr<TemporaryFolder> folder_;
};
std::unique_ptr<TemporaryFolder> CalibrateModeler::folder_;

std::vector<std::string> lines_of(const std::string& path) {
  std::vector<std::string> lines;
  std::istringstream text(read_text(path));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

TEST_F(CalibrateModeler, GivesTheSameBytesAgainWithAnyNumberOfJobs) {
  const ProgramResult two = run(command(file("two.yaml")));
  ASSERT_EQ(two.exit_code, 0) << two.error;
  EXPECT_THAT(two.out, AllOf(HasSubstr("region_growing.smoothness_deg"), HasSubstr("held back: 4 scenes")));
  const ProgramResult alone = run({program_path("calibrate_modeler"), dataset(), "--output", file("one.yaml"),
                                   "--budget", "4", "--jobs", "1", "--quiet"});
  ASSERT_EQ(alone.exit_code, 0) << alone.error;
  EXPECT_THAT(alone.error, ::testing::Not(HasSubstr("clouds")));  // no progress
  EXPECT_EQ(read_text(file("one.yaml")), read_text(file("two.yaml")));
}

TEST_F(CalibrateModeler, ModelTubesReadsTheOutputAndEvaluateFindsTheSameRecalls) {
  write_text(file("poor.yaml"), "method: region_growing\nregion_growing: {smoothness_deg: 1.5, region_size_min: 40}\n");
  const results::ModelConfig start = results::load_model_config(file("poor.yaml"));
  CalibrationOptions options{.dataset = dataset(), .output = file("tuned.yaml"), .parameters = {}, .budget = 6.0};
  options.jobs = 2;
  const CalibrationReport report = calibrate_modeler(options, start, jobs::Progress::Style::none);
  EXPECT_GT(report.training.mean_gain(), 0.1);

  for (const bool after : {false, true}) {
    const std::string results = file(after ? "results_after" : "results_before");
    ASSERT_EQ(run({program_path("model_tubes"), dataset(), "--output", results, "--quiet", "--config",
                   after ? options.output : file("poor.yaml")})
                  .exit_code,
              0);
    const std::set<std::string> held_back(report.held_back_scenes.begin(), report.held_back_scenes.end());
    double sum = 0.0;
    for (const evaluation::RunScore& score : results::read_results({results}, {}).runs)
      if (held_back.contains(score.key.scene)) sum += score.micro_recall;
    EXPECT_NEAR(sum / static_cast<double>(held_back.size()),
                after ? report.held_back.mean_after() : report.held_back.mean_before(), 1e-9);
  }
}

// The journal of trials, in which the tuned parameters find nothing on the scenes held back, stands for a search that
// suits the training scenes alone.
TEST_F(CalibrateModeler, WhatIsWorseOnTheHeldBackScenesIsNotRecommended) {
  write_text(file("start.yaml"), "method: region_growing\ngreedy_joining: {gap_max: 0.001}\n");
  CalibrationOptions options{.dataset = dataset(), .output = file("worse.yaml"), .parameters = {}, .budget = 4.0};
  const auto calibrate = [&] {
    return run({program_path("calibrate_modeler"), options.dataset, "--output", options.output, "--config",
                file("start.yaml"), "--budget", "4", "--quiet"});
  };
  const CalibrationReport report =
      calibrate_modeler(options, results::load_model_config(file("start.yaml")), jobs::Progress::Style::none);
  ASSERT_TRUE(report.is_recommended());
  ASSERT_GT(report.held_back.mean_before(), 0.0);
  ASSERT_NE(report.after, report.before);
  const ProgramResult better = calibrate();
  EXPECT_EQ(better.error, "");
  EXPECT_THAT(read_text(options.output), ::testing::Not(HasSubstr("recommended")));

  const std::string journal = options.output + ".trials/runs.jsonl";
  std::string text;
  for (const std::string& line : lines_of(journal)) {
    nlohmann::ordered_json trial = nlohmann::ordered_json::parse(line);
    if (trial.contains("scene") &&
        std::ranges::count(report.held_back_scenes, trial["scene"].get<std::string>()) == 1 &&
        trial["setting"]["greedy_joining.gap_max"] != 0.001)
      trial["micro_recall"] = 0.0;
    text += trial.dump() + "\n";
  }
  write_text(journal, text);
  const ProgramResult worse = calibrate();
  EXPECT_EQ(worse.exit_code, 0);
  EXPECT_THAT(worse.error, AllOf(HasSubstr("Warning: on the scenes that were held back the tuned parameters are worse"),
                                 HasSubstr(options.output + " is not recommended: keep the configuration")));
  EXPECT_THAT(read_text(options.output), HasSubstr("# Not recommended: worse on the scenes"));
}

TEST_F(CalibrateModeler, SplitsEveryGroupAlikeAndNoSceneIsOnBothSides) {
  CalibrationOptions options{.dataset = dataset(), .output = file("split.yaml"), .parameters = {}, .budget = 1.0};
  results::ModelConfig start;
  start.modeling.method = modeling::ModelingMethod::region_growing;
  std::set<std::vector<std::string>> splits;
  for (options.seed = 1; options.seed <= 3; ++options.seed) {
    const CalibrationReport report = calibrate_modeler(options, start, jobs::Progress::Style::none);
    std::set<std::string> all(report.training_scenes.begin(), report.training_scenes.end());
    all.insert(report.held_back_scenes.begin(), report.held_back_scenes.end());
    EXPECT_EQ(all.size(), 8U);
    for (const auto* scenes : {&report.training_scenes, &report.held_back_scenes})
      EXPECT_EQ(std::count_if(scenes->begin(), scenes->end(), [](const auto& name) { return name.starts_with("Q3/"); }),
                2);
    splits.insert(report.training_scenes);
  }
  EXPECT_GT(splits.size(), 1U);
}

TEST_F(CalibrateModeler, TunesNamedParametersAlone) {
  const ProgramResult result =
      run(command(file("named.yaml")), {"--parameter", "greedy_joining.gap_max", "--parameter",
                                        "region_growing.neighbors=10:30:log", "--ratios", "0.5,1"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const auto trials = lines_of(file("named.yaml.trials/runs.jsonl"));
  EXPECT_GT(std::ranges::count_if(trials, [](const auto& line) { return line.find("\"ratio\":0.5") != line.npos; }), 8);
  const results::ModelConfig tuned = results::load_model_config(file("named.yaml"));
  const results::ModelConfig defaults;
  EXPECT_GE(tuned.modeling.region_growing.neighbors, 10);
  EXPECT_LE(tuned.modeling.region_growing.neighbors, 30);
  EXPECT_EQ(tuned.modeling.region_growing.smoothness_deg, defaults.modeling.region_growing.smoothness_deg);
  EXPECT_EQ(tuned.modeling.method, modeling::ModelingMethod::region_growing);
}

TEST_F(CalibrateModeler, TunesNothingThatHasNoEffect) {
  const results::CloudToModel input = results::read_cloud_to_model(TUBEBIN_SOURCE_DIR "/data/A10/003/cloud.pcd");
  results::ModelConfig config;
  config.modeling.method = modeling::ModelingMethod::region_growing;
  config.modeling.filtering.ratio = 0.3;
  const auto labels_with = [&](const std::string& key, double value) {
    return results::model_cloud(input, apply_setting(config, {{.key = key, .range = {}}}, {value})).labels;
  };
  for (const TunedParameter& parameter : default_parameters(config.modeling.method))
    EXPECT_NE(labels_with(parameter.key, parameter.range.low), labels_with(parameter.key, parameter.range.high))
        << parameter.key;
}

TEST_F(CalibrateModeler, SaysThatAParameterOfEarlierVersionsWent) {
  write_text(file("old.yaml"), "method: region_growing\nregion_growing:\n  curvature_max: 0.05\n");
  const ProgramResult result = run(command(file("of_old.yaml")), {"--config", file("old.yaml")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.error, HasSubstr("old.yaml:3:18: region_growing.curvature_max: is no key any more"));
}

TEST_F(CalibrateModeler, RefusesWhatCannotBeMeant) {
  const auto expect_refused = [&](const std::vector<std::string>& more, const std::string& why) {
    const ProgramResult result = run(command(file("bad.yaml")), more);
    EXPECT_EQ(result.exit_code, 2) << why;
    EXPECT_THAT(result.error, HasSubstr(why));
    EXPECT_FALSE(fs::exists(file("bad.yaml")));
  };
  expect_refused({"--method", "centerline"}, "no parameters of its own to tune");
  expect_refused({"--parameter", "region_growing.neighbours"}, "no number of a configuration");
  expect_refused({"--parameter", "filtering.bin_margin=0:1"}, "which points are counted");
  expect_refused({"--parameter", "radius"}, "radius=LOW:HIGH");
  expect_refused({"--parameter", "region_growing.neighbors=2:30"}, "may be from 3 to 1000");
  expect_refused({"--parameter", "region_growing.neighbors=3.5:30"}, "whole numbers");
  expect_refused({"--parameter", "region_growing.neighbors=30:3"}, "not below");
  expect_refused({"--parameter", "greedy_joining.gap_max=0:1:log"}, "above 0");
  expect_refused({"--parameter", "greedy_joining.gap_max=a:1"}, "'a' is no number");
  expect_refused({"--parameter", "greedy_joining.gap_max", "--parameter", "greedy_joining.gap_max=0:1"}, "twice");
  expect_refused({"--held-back", "1.5"}, "--held-back");
  expect_refused({"--held-back", "0.99"}, "both need at least one");
  expect_refused({"--ratios", "0"}, "no ratio");
  const ProgramResult nowhere = run({program_path("calibrate_modeler"), file("nowhere"), "--output", file("bad.yaml")});
  EXPECT_EQ(nowhere.exit_code, 1);
  EXPECT_THAT(nowhere.error, HasSubstr("nowhere"));
}

TEST_F(CalibrateModeler, NeedsGroundTruth) {
  const std::string unlabelled = file("unlabelled");
  for (const char* name : {"Q1/001", "Q1/002"}) {
    fs::create_directories(fs::path(unlabelled) / name);
    write_text(unlabelled + "/" + name + "/cloud.pcd",
               "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
               "VIEWPOINT 0 0 2 0 1 0 0\nPOINTS 1\nDATA ascii\n0 0 0.1\n");
  }
  const ProgramResult result =
      run({program_path("calibrate_modeler"), unlabelled, "--output", file("bad.yaml"), "--jobs", "1"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.error, AllOf(HasSubstr("cloud.pcd"), HasSubstr("no labels")));
}

TEST_F(CalibrateModeler, KillsAtAnyMomentCostNothingButTheRunningModels) {
  ASSERT_EQ(run(command(file("undisturbed.yaml"))).exit_code, 0);
  const std::string journal = file("undisturbed.yaml.trials/runs.jsonl");
  const std::multiset<std::string> expected = [&] {
    const auto lines = lines_of(journal);
    return std::multiset<std::string>(lines.begin(), lines.end());
  }();
  std::mt19937 random(20220406);
  for (int round = 0; round < 4; ++round) {
    const std::string output = file("killed_" + std::to_string(round) + ".yaml");
    for (int kill_count = 0; kill_count < 5; ++kill_count) {
      Program program(command(output));
      std::this_thread::sleep_for(std::chrono::microseconds(random() % 250'000));
      kill(program.process(), SIGKILL);
      program.wait();
      wait_until([&] { return processes_of(output).empty(); });
    }
    const ProgramResult result = run(command(output));
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(read_text(output), read_text(file("undisturbed.yaml")));
    const auto lines = lines_of(output + ".trials/runs.jsonl");
    EXPECT_EQ(std::multiset<std::string>(lines.begin(), lines.end()), expected) << "each run once";
  }
}

TEST_F(CalibrateModeler, ALineThatWasCutShortIsMadeAgain) {
  const std::string output = file("cut.yaml");
  ASSERT_EQ(run(command(output)).exit_code, 0);
  const std::string expected = read_text(output), journal = output + ".trials/runs.jsonl";
  const std::string text = read_text(journal);
  write_text(journal, text.substr(0, text.size() - 20));
  const ProgramResult result = run(command(output));
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_THAT(result.out, HasSubstr("1 models made"));
  EXPECT_EQ(read_text(output), expected);
  write_text(journal, text.substr(0, text.size() / 2) + "\n" + text);
  const ProgramResult damaged = run(command(output));
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_THAT(damaged.error, AllOf(HasSubstr(journal + ":"), HasSubstr("is no trial")));
}

TEST_F(CalibrateModeler, CtrlCKeepsWhatIsDone) {
  const std::string output = file("stopped.yaml");
  Program program(command(output));
  wait_until([&] { return fs::exists(output + ".trials/runs.jsonl"); });
  kill(-program.process(), SIGINT);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exit_code, 128 + SIGINT);
  EXPECT_THAT(result.error, AllOf(HasSubstr("Interrupted after"), HasSubstr("same command again")));
  EXPECT_FALSE(fs::exists(output));
  EXPECT_TRUE(processes_of(output).empty());
  EXPECT_EQ(run(command(output)).exit_code, 0);
}

TEST_F(CalibrateModeler, SigtermIsHeardAlsoWhereScenesAreInPacks) {
  const std::string packed = file("packed"), output = file("of_packs.yaml");
  ASSERT_EQ(run_generate_dataset({file("quick.yaml"), "--output", packed, "--pack"}).exit_code, 0);
  std::vector<std::string> call = command(output);
  call[1] = packed;
  Program program(call);
  wait_until([&] { return fs::exists(output + ".trials/runs.jsonl"); });  // before the first pack is read
  kill(program.process(), SIGTERM);
  EXPECT_EQ(program.wait().exit_code, 128 + SIGTERM);
  EXPECT_FALSE(fs::exists(output));
  EXPECT_TRUE(processes_of(output).empty());
  EXPECT_EQ(run(call).exit_code, 0);
}

TEST_F(CalibrateModeler, AnotherConfigurationIsRefusedAndALargerBudgetGoesOn) {
  const std::string output = file("more.yaml");
  ASSERT_EQ(run(command(output)).exit_code, 0);
  const std::size_t models = lines_of(output + ".trials/runs.jsonl").size() - 1;
  const ProgramResult again =
      run({program_path("calibrate_modeler"), dataset(), "--output", output, "--budget", "6", "--quiet"});
  ASSERT_EQ(again.exit_code, 0) << again.error;
  EXPECT_GT(lines_of(output + ".trials/runs.jsonl").size() - 1, models);
  EXPECT_THAT(again.out, ::testing::Not(HasSubstr(", 0 there before")));
  write_text(file("other_start.yaml"), "method: region_growing\nradius: 0.0125\n");
  const ProgramResult other = run(command(output), {"--config", file("other_start.yaml")});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.error, HasSubstr("another configuration"));
}

}  // namespace
}  // namespace tubebin::testing
