// kill -9 at any moment, of every program in every mode: the same command goes on, gives the bytes of an undisturbed run,
// and leaves nothing else behind. A kill counts where it met a live run; each mode must have some.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <random>

#include "support/faults.hpp"

namespace tubebin::testing {
namespace {

constexpr int kLiveKillsWanted = 4;
constexpr int kTriesMax = 60;

/// A way to call a program, given the folder with its inputs and what it is to write.
struct Mode {
  const char* name;
  std::string (*command)(const std::string& in, const std::string& out);
};

void PrintTo(const Mode& mode, std::ostream* stream) { *stream << mode.name; }

const std::vector<Mode> kModes = {
    {"generate",
     [](const auto& in, const auto& out) { return "generate_dataset " + in + "/c.yaml -q -j 2 --output " + out; }},
    {"generate_packed",
     [](const auto& in, const auto& out) {
       return "generate_dataset " + in + "/c.yaml -q -j 2 --pack --output " + out;
     }},
    {"generate_shard",
     [](const auto& in, const auto& out) {
       return "generate_dataset " + in + "/c.yaml -q -j 2 --shard 1/1 --output " + out +
              " && generate_dataset -q --merge " + out;
     }},
    {"merge",
     [](const auto& in, const auto& out) {
       return "generate_dataset -q --merge " + out + " " + in + "/shard1 " + in + "/shard2";
     }},
    {"merge_packs",
     [](const auto& in, const auto& out) {
       return "generate_dataset -q --merge " + out + " " + in + "/pack1 " + in + "/pack2";
     }},
    {"model",
     [](const auto& in, const auto& out) {
       return "model_tubes " + in + "/data -q -j 2 --ratios 0.5,1 --keep-clouds --output " + out;
     }},
    {"export_npz",
     [](const auto& in, const auto& out) {
       return "export_dataset " + in + "/data -q -j 2 --format npz --output " + out;
     }},
    {"export_ply",
     [](const auto& in, const auto& out) {
       return "export_dataset " + in + "/data -q -j 2 --format ply --output " + out;
     }},
    {"export_sdf",
     [](const auto& in, const auto& out) {
       return "export_dataset " + in + "/data -q -j 2 --format sdf --output " + out;
     }},
    {"export_coco",
     [](const auto& in, const auto& out) {
       return "export_dataset " + in + "/data -q -j 2 --format coco --output " + out;
     }},
    {"export_bop",
     [](const auto& in, const auto& out) {
       return "export_dataset " + in + "/data -q -j 2 --format bop --output " + out;
     }},
    {"calibrate",
     [](const auto& in, const auto& out) {
       return "mkdir -p " + out + " && calibrate_modeler " + in + "/data -q -j 2 --budget 2 --output " + out +
              "/modeling.yaml";
     }},
    {"evaluate", [](const auto& in, const auto& out) {
       return "mkdir -p " + out + " && evaluate " + in + "/results -q --html " + out + "/report.html --plots " + out +
              "/plots > /dev/null";
     }}};

class KillHarness : public ::testing::TestWithParam<Mode> {
 protected:
  /// Inputs for all modes, made once.
  static void SetUpTestSuite() {
    inputs_ = std::make_unique<TemporaryFolder>();
    write_text(in() + "/c.yaml",
               "set: K\nseed: 3\ntubes: [1, 2]\ncases: 4\ntube: {length: 0.2, cylinder_count_max: 6}\n"
               "scanner: {width: 240, height: 150}\n");
    const std::string generate = "generate_dataset " + in() + "/c.yaml -q --output " + in();
    for (const std::string& command :
         {generate + "/data", generate + "/shard1 --shard 1/2", generate + "/shard2 --shard 2/2",
          generate + "/pack1 --shard 1/2 --pack", generate + "/pack2 --shard 2/2 --pack",
          "model_tubes " + in() + "/data -q --output " + in() + "/results"})
      ASSERT_EQ(shell(command).wait().exit_code, 0) << command;
  }
  static void TearDownTestSuite() { inputs_.reset(); }

  static std::string in() { return fs::path(*inputs_ / "").parent_path().string(); }
  static Program shell(const std::string& command) {
    return Program({"/bin/bash", "-c", "PATH=" TUBEBIN_BIN_DIR ":$PATH; " + command});
  }

  /// Names and bytes, but for what is of a run's time or a process.
  static std::map<std::string, std::string> content(const std::string& folder) {
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
      const std::string name = fs::relative(entry.path(), folder).string();
      if (!entry.is_regular_file() || entry.path().filename().string() == ".lock") continue;
      const bool varies = name.ends_with("times.json") || name.ends_with(".jsonl");
      files[name] = varies ? "" : read_text(entry.path());
    }
    return files;
  }

  TemporaryFolder folder_;
  static inline std::unique_ptr<TemporaryFolder> inputs_;
};

TEST_P(KillHarness, TheSameCommandGoesOnAndLeavesNothingElse) {
  const Mode& mode = GetParam();
  const std::string undisturbed = folder_ / "undisturbed", out = folder_ / "out";
  const auto start = std::chrono::steady_clock::now();
  Program first = shell(mode.command(in(), undisturbed));
  const ProgramResult whole = first.wait();
  ASSERT_EQ(whole.exit_code, 0) << whole.error;
  const auto duration = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);

  std::mt19937 random(20241122);
  int live_kills = 0, tries = 0;
  for (; tries < kTriesMax && live_kills < kLiveKillsWanted; ++tries) {
    // Each third kill meets what earlier ones left; the others begin anew.
    if (tries % 3 == 0) fs::remove_all(out);
    Program program = shell(mode.command(in(), out));
    std::this_thread::sleep_for(std::chrono::microseconds(random() % static_cast<unsigned>(duration.count() + 1)));
    live_kills += program.running();
    kill(-program.process(), SIGKILL);
    program.wait();
    // Until its parents have reaped it, a process seems to live.
    wait_until([&] { return processes_of(out).empty() && kill(-program.process(), 0) != 0; });
  }
  EXPECT_GE(live_kills, kLiveKillsWanted) << "of " << tries << " kills";

  const ProgramResult last = shell(mode.command(in(), out)).wait();
  EXPECT_EQ(last.exit_code, 0) << last.error;
  EXPECT_EQ(content(out), content(undisturbed));
}

INSTANTIATE_TEST_SUITE_P(AllModes, KillHarness, ::testing::ValuesIn(kModes),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace tubebin::testing
