// Interruptions, kills and full disks, really done: what is complete stays, a new run completes the rest, and the
// result has the same bytes as an undisturbed run.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

#include "support/faults.hpp"
#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/dataset/manifest.hpp"

namespace tubebin::testing {

using namespace dataset;
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Interruption : public ::testing::Test {
 protected:
  Interruption() {
    write_text(config_, quick_config());
    EXPECT_EQ(run_generate_dataset(command(undisturbed_)).exit_code, 0);
    expected_ = scene_files(undisturbed_);
  }

  std::vector<std::string> command(const std::string& output) const {
    return {config_, "--output", output, "--cases", "8", "--jobs", "2"};
  }
  Program start(const std::string& output) const {
    std::vector<std::string> arguments = command(output);
    arguments.insert(arguments.begin(), program_path("generate_dataset"));
    return Program(arguments);
  }

  /// Every scene that stands under its name is the one of an undisturbed run, and whole.
  void expect_only_whole_scenes(const std::string& output) const {
    std::map<std::string, int> files_of_scene;
    for (const auto& [name, bytes] : scene_files(output)) {
      if (name.find("/.") != std::string::npos) continue;  // unfinished, not under a scene's name
      EXPECT_TRUE(expected_.contains(name) && expected_.at(name) == bytes) << name;
      ++files_of_scene[fs::path(name).parent_path().string()];
    }
    for (const auto& [scene, count] : files_of_scene) EXPECT_EQ(count, 3) << scene;
  }

  void expect_completed_as_undisturbed(const std::string& output) const {
    const ProgramResult result = run_generate_dataset(command(output));
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(scene_files(output), expected_);
    EXPECT_EQ(Manifest(output).records().size(), 16u);
    EXPECT_EQ(run_generate_dataset({"--verify", output}).exit_code, 0);
  }

  TemporaryFolder folder_;
  std::string config_ = folder_ / "quick.yaml";
  std::string undisturbed_ = folder_ / "undisturbed";
  std::map<std::string, std::string> expected_;
  std::mt19937 random_{20220405};  // for the moments of the faults
};

TEST_F(Interruption, KillOfTheParentAtAnyMoment) {
  int kills_of_live_runs = 0;
  for (int round = 0; round < 12; ++round) {
    const std::string data = folder_ / fmt::format("parent_{}", round);
    for (int kill_count = 0; kill_count < 3; ++kill_count) {
      Program program = start(data);
      std::this_thread::sleep_for(std::chrono::microseconds(random_() % 250'000));
      kills_of_live_runs += program.running() ? 1 : 0;
      kill(program.process(), SIGKILL);
      program.wait();
      wait_until([&] { return processes_of(data).empty(); });  // workers die with their parent
      if (fs::exists(data)) expect_only_whole_scenes(data);
    }
    expect_completed_as_undisturbed(data);
  }
  EXPECT_GT(kills_of_live_runs, 0);
}

TEST_F(Interruption, KillOfWorkersAtAnyMoment) {
  int kills = 0;
  for (int round = 0; round < 8; ++round) {
    const std::string data = folder_ / fmt::format("worker_{}", round);
    Program program = start(data);
    for (int kill_count = 0; kill_count < 6 && program.running(); ++kill_count) {
      // The first as soon as there is a worker, so that some kill meets one however fast the machine is.
      wait_until([&] { return !program.running() || processes_of(data).size() > 1; });
      if (kill_count > 0) std::this_thread::sleep_for(std::chrono::microseconds(random_() % 60'000));
      for (const pid_t process : processes_of(data))
        if (process != program.process()) {
          kill(process, SIGKILL);
          ++kills;
          break;
        }
    }
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(scene_files(data), expected_);
  }
  EXPECT_GT(kills, 0);
}

TEST_F(Interruption, StopSignalsEndTheRunAndSayHowToGoOn) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const std::string data = folder_ / fmt::format("signal_{}", signal);
    Program program = start(data);
    wait_until([&] { return fs::exists(data + "/manifest.jsonl"); });
    kill(-program.process(), signal);  // the whole group, as a terminal does
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 128 + signal);
    EXPECT_THAT(result.error, AllOf(HasSubstr("Interrupted after"), HasSubstr("same command again")));
    EXPECT_TRUE(processes_of(data).empty());
    for (const auto& [name, bytes] : scene_files(data)) EXPECT_EQ(name.find("/."), std::string::npos) << name;
    expect_only_whole_scenes(data);
    expect_completed_as_undisturbed(data);
  }
}

TEST_F(Interruption, CtrlCEndsWorkersThatHangInTwoSeconds) {
  double least = kStopSecondsMax + 1.0;
  for (int i = 0; i < kStopTries && least > kStopSecondsMax; ++i) {
    const std::string data = folder_ / fmt::format("hanging_{}", i);
    Program program = start(data);
    wait_until([&] { return fs::exists(data + "/manifest.jsonl"); });
    const Stop stop = stop_hanging(program, data);
    EXPECT_EQ(stop.result.exit_code, 128 + SIGINT);
    EXPECT_THAT(stop.result.error, AllOf(HasSubstr("Interrupted after"), HasSubstr("same command again")));
    EXPECT_TRUE(processes_of(data).empty());
    expect_completed_as_undisturbed(data);
    least = std::min(least, stop.seconds);
  }
  EXPECT_LE(least, kStopSecondsMax);
}

TEST_F(Interruption, AManifestCutAnywhereIsCompleted) {
  const std::string data = folder_ / "cut";
  ASSERT_EQ(run_generate_dataset(command(data)).exit_code, 0);
  for (int round = 0; round < 6; ++round) {
    fs::resize_file(data + "/manifest.jsonl", random_() % fs::file_size(data + "/manifest.jsonl"));
    expect_completed_as_undisturbed(data);
  }
}

TEST_F(Interruption, ASecondRunIsRefusedUntilTheFirstIsDead) {
  const std::string data = folder_ / "twice";
  Program first = start(data);
  wait_until([&] { return fs::exists(data + "/manifest.jsonl"); });
  kill(first.process(), SIGSTOP);
  const ProgramResult second = run_generate_dataset(command(data));
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.error, HasSubstr(fmt::format("process {} is writing to this folder", first.process())));
  kill(first.process(), SIGKILL);
  first.wait();
  expect_completed_as_undisturbed(data);
}

class FullDisk : public Interruption {
 protected:
  void SetUp() override {
    if (!disk_.mounted()) GTEST_SKIP() << disk_.why_not();
  }

  SmallDisk disk_;
};

TEST_F(FullDisk, EndsTheRunAndKeepsWhatIsWhole) {
  for (const std::uintmax_t free : {0, 4'096, 10'000, 40'000, 100'000, 300'000, 600'000}) {
    disk_.leave_free(free);
    const std::string data = disk_ / fmt::format("data_{}", free);
    const ProgramResult full = run_generate_dataset(command(data));
    EXPECT_EQ(full.exit_code, 1) << free << full.error;
    EXPECT_THAT(full.error, AllOf(HasSubstr(disk_.path()), HasSubstr("No space left"))) << free;
    if (fs::exists(data)) {
      expect_only_whole_scenes(data);
      for (const auto& [name, bytes] : scene_files(data)) EXPECT_EQ(name.find("/."), std::string::npos) << name;
    }
    disk_.leave_all_free();
    expect_completed_as_undisturbed(data);
    fs::remove_all(data);
  }
}

TEST_F(FullDisk, AReadOnlyDiskIsNamed) {
  disk_.make_read_only();
  const ProgramResult result = run_generate_dataset(command(disk_ / "data"));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.error, AllOf(HasSubstr(disk_.path()), HasSubstr("Read-only")));
}

}  // namespace
}  // namespace tubebin::testing
