// Interruptions, kills and full disks, really done: what is complete stays, a new run completes the rest, and the
// result has the same bytes as an undisturbed run.
#include <gmock/gmock.h>
#include <sys/mount.h>
#include <sys/vfs.h>

#include <chrono>
#include <random>
#include <thread>

#include "dataset/program.hpp"
#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/dataset/manifest.hpp"

namespace tubebin::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// Processes whose command line names the folder.
std::vector<pid_t> processes_of(const std::string& folder) {
  std::vector<pid_t> found;
  for (const fs::directory_entry& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (read_text(entry.path() / "cmdline").find(folder) != std::string::npos) found.push_back(std::stoi(name));
  }
  return found;
}

/// Waits for something that must come; the test's own time limit ends a wait that is in vain.
template <typename Condition>
void wait_until(Condition condition) {
  while (!condition()) std::this_thread::sleep_for(1ms);
}

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
  for (int round = 0; round < 12; ++round) {
    const std::string data = folder_ / fmt::format("parent_{}", round);
    for (int kill_count = 0; kill_count < 3; ++kill_count) {
      Program program = start(data);
      std::this_thread::sleep_for(std::chrono::microseconds(random_() % 250'000));
      kill(program.process(), SIGKILL);
      program.wait();
      wait_until([&] { return processes_of(data).empty(); });  // workers die with their parent
      if (fs::exists(data)) expect_only_whole_scenes(data);
    }
    expect_completed_as_undisturbed(data);
  }
}

TEST_F(Interruption, KillOfWorkersAtAnyMoment) {
  for (int round = 0; round < 8; ++round) {
    const std::string data = folder_ / fmt::format("worker_{}", round);
    Program program = start(data);
    for (int kill_count = 0; kill_count < 6 && program.running(); ++kill_count) {
      std::this_thread::sleep_for(std::chrono::microseconds(random_() % 60'000));
      for (const pid_t process : processes_of(data))
        if (process != program.process()) {
          kill(process, SIGKILL);
          break;
        }
    }
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(scene_files(data), expected_);
  }
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

/// A small file system of its own, where the test may mount one.
class FullDisk : public Interruption {
 protected:
  void SetUp() override {
    fs::create_directory(disk_);
    if (mount("tmpfs", disk_.c_str(), "tmpfs", 0, "size=4m") != 0)
      GTEST_SKIP() << "cannot mount a small tmpfs (needs root): " << std::strerror(errno);
    mounted_ = true;
  }
  void TearDown() override {
    if (mounted_) umount2(disk_.c_str(), MNT_DETACH);
  }

  /// A file that leaves so many bytes free.
  void leave_free(std::uintmax_t bytes) {
    fs::remove(disk_ + "/filler");
    const std::uintmax_t available = fs::space(disk_).available;
    write_text(disk_ + "/filler", std::string(available > bytes ? available - bytes : 0, 'x'));
  }

  std::string disk_ = folder_ / "disk";
  bool mounted_ = false;
};

TEST_F(FullDisk, EndsTheRunAndKeepsWhatIsWhole) {
  for (const std::uintmax_t free : {0, 4'096, 10'000, 40'000, 100'000, 300'000, 600'000}) {
    leave_free(free);
    const std::string data = disk_ + fmt::format("/data_{}", free);
    const ProgramResult full = run_generate_dataset(command(data));
    EXPECT_EQ(full.exit_code, 1) << free << full.error;
    EXPECT_THAT(full.error, AllOf(HasSubstr(disk_), HasSubstr("No space left"))) << free;
    if (fs::exists(data)) {
      expect_only_whole_scenes(data);
      for (const auto& [name, bytes] : scene_files(data)) EXPECT_EQ(name.find("/."), std::string::npos) << name;
    }
    fs::remove(disk_ + "/filler");
    expect_completed_as_undisturbed(data);
    fs::remove_all(data);
  }
}

TEST_F(FullDisk, AReadOnlyDiskIsNamed) {
  ASSERT_EQ(mount("tmpfs", disk_.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, "size=4m"), 0);
  const ProgramResult result = run_generate_dataset(command(disk_ + "/data"));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.error, AllOf(HasSubstr(disk_), HasSubstr("Read-only")));
}

}  // namespace
}  // namespace tubebin::testing
