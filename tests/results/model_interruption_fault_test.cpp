// model_tubes over a data set, killed, stopped and without disk space: what is complete stays, a new run completes the
// rest, and the results have the same bytes as those of an undisturbed run.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>

#include "support/faults.hpp"

namespace tubebin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

ProgramResult run_model_tubes(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), program_path("model_tubes"));
  return Program(arguments).wait();
}

/// Everything but the times, which differ from run to run.
std::map<std::string, std::string> result_files(const std::string& results) {
  std::map<std::string, std::string> files = scene_files(results);
  std::erase_if(files, [](const auto& file) { return file.first.ends_with("/times.json"); });
  return files;
}

/// But for the data set's path, which is relative to the folder.
nlohmann::json index_of(const std::string& results) {
  nlohmann::json index = nlohmann::json::parse(read_text(results + "/index.json"));
  index.erase("dataset");
  return index;
}

bool is_unfinished(const std::string& file) { return file.find("/.") != std::string::npos; }

class ModelInterruption : public ::testing::Test {
 protected:
  ModelInterruption() {
    write_text(folder_ / "quick.yaml", quick_config());
    EXPECT_EQ(run_generate_dataset({folder_ / "quick.yaml", "--output", dataset_}).exit_code, 0);
    EXPECT_EQ(run_model_tubes(command(undisturbed_)).exit_code, 0);
    expected_ = result_files(undisturbed_);
    EXPECT_EQ(expected_.size(), 8 * 2 * 4 * kFilesOfRun);
  }

  /// Eight clouds by two methods at four ratios.
  std::vector<std::string> command(const std::string& output) const {
    return {dataset_, "--output", output,   "--method",      "both", "--ratios", "0.1:1:.3", "--jobs",
            "2",      "--radius", "0.0125", "--tube-length", "0.2",  "--seed",   "4",        "--keep-clouds"};
  }
  Program start(const std::string& output) const {
    std::vector<std::string> arguments = command(output);
    arguments.insert(arguments.begin(), program_path("model_tubes"));
    return Program(arguments);
  }

  /// Every run that stands under its name is the one of an undisturbed call, and whole.
  void expect_only_whole_runs(const std::string& output) const {
    std::map<std::string, std::size_t> files_of_run;
    for (const auto& [name, bytes] : result_files(output)) {
      if (is_unfinished(name)) continue;
      EXPECT_TRUE(expected_.contains(name) && expected_.at(name) == bytes) << name;
      ++files_of_run[fs::path(name).parent_path().string()];
    }
    for (const auto& [run, count] : files_of_run) EXPECT_EQ(count, kFilesOfRun) << run;
  }

  void expect_completed_as_undisturbed(const std::string& output) const {
    const ProgramResult result = run_model_tubes(command(output));
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(result_files(output), expected_);
    EXPECT_EQ(index_of(output), index_of(undisturbed_));
    EXPECT_FALSE(fs::exists(output + "/failures.jsonl"));
  }

  static constexpr std::size_t kFilesOfRun = 4;  // beside times.json
  TemporaryFolder folder_;
  std::string dataset_ = folder_ / "dataset";
  std::string undisturbed_ = folder_ / "undisturbed";
  std::map<std::string, std::string> expected_;
  std::mt19937 random_{20220406};  // for the moments of the faults
};

TEST_F(ModelInterruption, KillOfTheParentAtAnyMoment) {
  int kills_of_live_runs = 0;
  for (int round = 0; round < 12; ++round) {
    const std::string results = folder_ / fmt::format("parent_{}", round);
    for (int kill_count = 0; kill_count < 3; ++kill_count) {
      Program program = start(results);
      std::this_thread::sleep_for(std::chrono::microseconds(random_() % 150'000));
      kills_of_live_runs += program.running() ? 1 : 0;
      kill(program.process(), SIGKILL);
      program.wait();
      wait_until([&] { return processes_of(results).empty(); });  // workers die with their parent
      if (fs::exists(results)) expect_only_whole_runs(results);
    }
    expect_completed_as_undisturbed(results);
  }
  EXPECT_GT(kills_of_live_runs, 0);
}

TEST_F(ModelInterruption, KillOfWorkersAtAnyMoment) {
  int kills = 0;
  for (int round = 0; round < 8; ++round) {
    const std::string results = folder_ / fmt::format("worker_{}", round);
    Program program = start(results);
    for (int kill_count = 0; kill_count < 6 && program.running(); ++kill_count) {
      // The first as soon as there is a worker, so that some kill meets one however fast the machine is.
      wait_until([&] { return !program.running() || processes_of(results).size() > 1; });
      if (kill_count > 0) std::this_thread::sleep_for(std::chrono::microseconds(random_() % 60'000));
      for (const pid_t process : processes_of(results))
        if (process != program.process()) {
          kill(process, SIGKILL);
          ++kills;
          break;
        }
    }
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(result_files(results), expected_);
  }
  EXPECT_GT(kills, 0);
}

TEST_F(ModelInterruption, StopSignalsEndTheCallAndSayHowToGoOn) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const std::string results = folder_ / fmt::format("signal_{}", signal);
    Program program = start(results);
    wait_until([&] { return fs::exists(results + "/Q1/001"); });
    kill(-program.process(), signal);  // the whole group, as a terminal does
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 128 + signal);
    EXPECT_THAT(result.error,
                AllOf(HasSubstr("Interrupted after"), HasSubstr("of 64 runs"), HasSubstr("same command again")));
    EXPECT_TRUE(processes_of(results).empty());
    for (const auto& [name, bytes] : result_files(results)) EXPECT_FALSE(is_unfinished(name)) << name;
    expect_only_whole_runs(results);
    expect_completed_as_undisturbed(results);
  }
}

TEST_F(ModelInterruption, CtrlCEndsWorkersThatHangInTwoSeconds) {
  double least = kStopSecondsMax + 1.0;
  for (int i = 0; i < kStopTries && least > kStopSecondsMax; ++i) {
    const std::string results = folder_ / fmt::format("hanging_{}", i);
    Program program = start(results);
    wait_until([&] { return fs::exists(results + "/Q1/001"); });
    const Stop stop = stop_hanging(program, results);
    EXPECT_EQ(stop.result.exit_code, 128 + SIGINT);
    EXPECT_THAT(stop.result.error, HasSubstr("Interrupted after"));
    EXPECT_TRUE(processes_of(results).empty());
    expect_completed_as_undisturbed(results);
    least = std::min(least, stop.seconds);
  }
  EXPECT_LE(least, kStopSecondsMax);
}

TEST_F(ModelInterruption, ASecondCallIsRefusedUntilTheFirstIsDead) {
  const std::string results = folder_ / "twice";
  Program first = start(results);
  wait_until([&] { return fs::exists(results + "/Q1"); });
  kill(first.process(), SIGSTOP);
  const ProgramResult second = run_model_tubes(command(results));
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.error, HasSubstr(fmt::format("process {} is writing to this folder", first.process())));
  kill(first.process(), SIGKILL);
  first.wait();
  expect_completed_as_undisturbed(results);
}

TEST_F(ModelInterruption, AnIndexCutAnywhereIsNamed) {
  const std::string results = folder_ / "cut";
  ASSERT_EQ(run_model_tubes(command(results)).exit_code, 0);
  const std::string index = read_text(undisturbed_ + "/index.json");
  for (int round = 0; round < 6; ++round) {
    write_text(results + "/index.json", index.substr(0, random_() % (index.size() - 2)));
    const ProgramResult result = run_model_tubes(command(results));
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.error, HasSubstr(results + "/index.json"));
  }
  fs::remove(results + "/index.json");
  expect_completed_as_undisturbed(results);
}

class ModelFullDisk : public ModelInterruption {
 protected:
  void SetUp() override {
    if (!disk_.mounted()) GTEST_SKIP() << disk_.why_not();
  }

  SmallDisk disk_;
};

TEST_F(ModelFullDisk, EndsTheCallAndKeepsWhatIsWhole) {
  for (const std::uintmax_t free : {0, 4'096, 10'000, 40'000, 100'000, 300'000}) {
    disk_.leave_free(free);
    const std::string results = disk_ / fmt::format("results_{}", free);
    const ProgramResult full = run_model_tubes(command(results));
    EXPECT_EQ(full.exit_code, 1) << free << full.error;
    EXPECT_THAT(full.error, AllOf(HasSubstr(disk_.path()), HasSubstr("No space left"))) << free;
    if (fs::exists(results)) {
      expect_only_whole_runs(results);
      for (const auto& [name, bytes] : result_files(results)) EXPECT_FALSE(is_unfinished(name)) << name;
    }
    disk_.leave_all_free();
    expect_completed_as_undisturbed(results);
    fs::remove_all(results);
  }
}

TEST_F(ModelFullDisk, AReadOnlyDiskIsNamed) {
  disk_.make_read_only();
  const ProgramResult result = run_model_tubes(command(disk_ / "results"));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.error, AllOf(HasSubstr(disk_.path()), HasSubstr("Read-only")));
}

}  // namespace
}  // namespace tubebin::testing
