// Data sets made in shards: into one folder or several, at once, interrupted, merged. The scenes are those of one machine,
// byte for byte.
#include <cstdlib>

#include "dataset/shards.hpp"
#include "tubebin/dataset/dataset_folder.hpp"

namespace tubebin::testing {

using namespace dataset;
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A scheduler's variables, for the programs that are started while it lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) { setenv(name, value.c_str(), 1); }
  ~Variable() { unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

TEST_F(Shards, WriteOneFolderAtOnce) {
  std::vector<std::unique_ptr<Program>> shards;
  for (const char* shard : {"1/3", "2/3", "3/3"}) {
    std::vector<std::string> arguments = command(data_, {"--shard", shard});
    arguments.insert(arguments.begin(), program_path("generate_dataset"));
    shards.push_back(std::make_unique<Program>(arguments));
  }
  for (const auto& shard : shards) {
    const ProgramResult result = shard->wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_THAT(result.error, AllOf(HasSubstr("of 3 (--shard): "), HasSubstr("of 8 scenes, ")));
  }
  EXPECT_EQ(Manifest(data_).records().size(), 8u);  // from the shards' files
  EXPECT_EQ(run_generate_dataset({"--verify", data_}).exit_code, 0);
  const ProgramResult merged = run_generate_dataset({"--merge", data_});
  EXPECT_EQ(merged.exit_code, 0) << merged.out << merged.error;
  EXPECT_THAT(merged.out, HasSubstr("8 of 8 scenes are complete and sound, 0 are missing"));
  expect_as_of_one_machine(data_);
}

TEST_F(Shards, AreTakenFromTheEnvironment) {
  {
    const Variable id("SLURM_ARRAY_TASK_ID", "12"), min("SLURM_ARRAY_TASK_MIN", "10"),
        max("SLURM_ARRAY_TASK_MAX", "12"), step("SLURM_ARRAY_TASK_STEP", "2"), count("SLURM_ARRAY_TASK_COUNT", "2");
    EXPECT_THAT(generate(data_).error, HasSubstr("Shard 2 of 2 (SLURM_ARRAY_TASK_ID=12, SLURM_ARRAY_TASK_MIN=10, "));
    EXPECT_EQ(generate(data_, {"--shard-count", "3"}).exit_code, 2);
  }
  {
    const Variable index("JOB_COMPLETION_INDEX", "0");
    EXPECT_EQ(generate(data_).exit_code, 2);
    const Variable count("TUBEBIN_SHARD_COUNT", "2");
    EXPECT_THAT(generate(data_).error, HasSubstr("Shard 1 of 2 (JOB_COMPLETION_INDEX=0, shard count 2): "));
  }
  EXPECT_EQ(scene_files(data_), expected_);
}

TEST_F(Shards, GoOnWhereTheyWereKilled) {
  for (int round = 0; round < 3; ++round) {
    std::vector<std::string> arguments = command(data_, {"--shard", "1/2"});
    arguments.insert(arguments.begin(), program_path("generate_dataset"));
    Program shard(arguments);
    wait_until([&] { return !shard.running() || Manifest(data_).records().size() > static_cast<std::size_t>(round); });
    kill(shard.process(), SIGKILL);
    shard.wait();
  }
  const ProgramResult first = generate(data_, {"--shard", "1/2"});
  EXPECT_EQ(first.exit_code, 0) << first.error;
  EXPECT_THAT(first.error, Not(HasSubstr(" 0 were there before")));
  EXPECT_EQ(generate(data_, {"--shard", "2/2"}).exit_code, 0);
  EXPECT_EQ(run_generate_dataset({"--merge", data_}).exit_code, 0);
  expect_as_of_one_machine(data_);
}

TEST_F(Shards, LeaveTheUnfinishedScenesOfOthersAlone) {
  fs::create_directories(data_ + "/Q1/.001.other-1-0.partial");
  const auto of = [&](const std::string& shard) {
    return list_scenes(
        [&] {
          DatasetConfig config = read_dataset_config(one_machine_);
          return config;
        }(),
        jobs::parse_shard(shard));
  };
  const std::vector<SceneId> first = of("1/2");
  const bool is_first = std::ranges::find(first, SceneId{"Q", 1, 1}) != first.end();
  write_text(data_ + "/config.yaml", read_text(one_machine_ + "/config.yaml"));
  EXPECT_EQ(generate(data_, {"--shard", is_first ? "2/2" : "1/2"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(data_ + "/Q1/.001.other-1-0.partial"));
  EXPECT_EQ(generate(data_, {"--shard", is_first ? "1/2" : "2/2"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(data_ + "/Q1/.001.other-1-0.partial"));
}

TEST_F(Shards, RunTwiceAtOnceDoNoHarm) {
  // As where a scheduler gives a lost node's task to another, and the node was only unreachable.
  std::vector<std::string> arguments = command(data_, {"--shard", "1/2"});
  arguments.insert(arguments.begin(), program_path("generate_dataset"));
  for (int round = 0; round < 4; ++round) {
    fs::remove_all(data_);
    Program lost(arguments);
    std::this_thread::sleep_for(std::chrono::milliseconds(30 * round));
    Program other(arguments);
    // Who starts to work last clears away what the other has not finished, and goes through; that may be either.
    const auto [least, most] = std::minmax({lost.wait().exit_code, other.wait().exit_code});
    EXPECT_EQ(least, 0);
    EXPECT_LE(most, 1);
    EXPECT_EQ(generate(data_, {"--shard", "2/2"}).exit_code, 0);
    EXPECT_EQ(run_generate_dataset({"--merge", data_}).exit_code, 0);
    expect_as_of_one_machine(data_);
  }
}

TEST_F(Shards, KeepOutWhoWantsTheFolderForHimself) {
  const jobs::FolderLock shard(OutputFolder(data_), jobs::FolderLock::Kind::shard);
  EXPECT_EQ(generate(data_, {"--shard", "1/2"}).exit_code, 0);
  EXPECT_EQ(generate(data_).exit_code, 2);
  EXPECT_EQ(run_generate_dataset({"--merge", data_}).exit_code, 2);
}

class Merge : public Shards {
 protected:
  std::string shard(int i) const { return folder_ / ("shard_" + std::to_string(i)); }
  void make_shard(int i, std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--shard", std::to_string(i) + "/3"});
    ASSERT_EQ(generate(shard(i), more).exit_code, 0);
  }
  ProgramResult merge(const std::vector<int>& shards) {
    std::vector<std::string> arguments = {"--merge", data_};
    for (const int i : shards) arguments.push_back(shard(i));
    return run_generate_dataset(arguments);
  }
};

TEST_F(Merge, JoinsFoldersOfParts) {
  for (int i = 1; i <= 3; ++i) make_shard(i);
  const auto before = scene_files(shard(2));
  const ProgramResult merged = merge({1, 2, 3});
  EXPECT_EQ(merged.exit_code, 0) << merged.out << merged.error;
  expect_as_of_one_machine(data_);
  EXPECT_EQ(scene_files(shard(2)), before);
  // Links, not copies.
  EXPECT_EQ(fs::hard_link_count(data_ + "/Q3/001/cloud.pcd"), 2u);
  EXPECT_EQ(merge({3, 1, 2}).exit_code, 0);
  expect_as_of_one_machine(data_);
}

TEST_F(Merge, NamesWhatIsMissingAndHowToMakeJustThat) {
  make_shard(1);
  make_shard(3);
  const std::size_t there = scene_files(shard(1)).size() / 3 + scene_files(shard(3)).size() / 3;
  const ProgramResult merged = merge({1, 3});
  EXPECT_EQ(merged.exit_code, 3);
  EXPECT_THAT(merged.out,
              HasSubstr(fmt::format("{} of 8 scenes are complete and sound, {} are missing", there, 8 - there)));
  for (const SceneId& id : list_scenes(read_dataset_config(data_), {2, 3}))
    EXPECT_THAT(merged.out, HasSubstr("  " + id.name() + "\n"));
  const ProgramResult made = run_printed_command(merged.out);
  EXPECT_EQ(made.exit_code, 0) << made.error;
  EXPECT_THAT(made.error, HasSubstr(fmt::format("{} made", 8 - there)));
  expect_as_of_one_machine(data_);
}

TEST_F(Merge, CompletesASharedFolderWhereAPartIsMissing) {
  ASSERT_EQ(generate(data_, {"--shard", "2/3"}).exit_code, 0);
  const ProgramResult merged = run_generate_dataset({"--merge", data_});
  EXPECT_EQ(merged.exit_code, 3);
  EXPECT_TRUE(fs::exists(data_ + "/manifest.parts"));  // other shards may still be at work
  EXPECT_EQ(run_printed_command(merged.out).exit_code, 0);
  EXPECT_EQ(run_generate_dataset({"--merge", data_}).exit_code, 0);
  expect_as_of_one_machine(data_);
}

TEST_F(Merge, RefusesFoldersOfAnotherSeedOrConfiguration) {
  make_shard(1);
  make_shard(2, {"--seed", "6"});
  const ProgramResult merged = merge({1, 2});
  EXPECT_EQ(merged.exit_code, 2);
  EXPECT_THAT(merged.error, AllOf(HasSubstr(shard(1)), HasSubstr(shard(2)), HasSubstr("seed: 5 there, 6 here")));
  EXPECT_FALSE(fs::exists(data_));
  EXPECT_EQ(run_generate_dataset({"--merge", data_, folder_ / "nowhere"}).exit_code, 1);
}

TEST_F(Merge, FindsAByteThatFlipped) {
  for (int i = 1; i <= 3; ++i) make_shard(i);
  const std::string scene = list_scenes(read_dataset_config(shard(2)), {2, 3}).front().name();
  std::string bytes = read_text(shard(2) + "/" + scene + "/cloud.pcd");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_text(shard(2) + "/" + scene + "/cloud.pcd", bytes);
  const ProgramResult merged = merge({1, 2, 3});
  EXPECT_EQ(merged.exit_code, 3);
  EXPECT_THAT(merged.out,
              AllOf(HasSubstr(shard(2) + "/" + scene + ": cloud.pcd has hash"), HasSubstr("7 of 8 scenes")));
  EXPECT_EQ(run_printed_command(merged.out).exit_code, 0);
  expect_as_of_one_machine(data_);
}

TEST_F(Merge, RepairsASharedFolder) {
  ASSERT_EQ(generate(data_, {"--shard", "1/1"}).exit_code, 0);
  fs::resize_file(data_ + "/Q1/003/cloud.pcd", 1000);
  const ProgramResult merged = run_generate_dataset({"--merge", data_});
  EXPECT_EQ(merged.exit_code, 3);
  EXPECT_THAT(merged.out, HasSubstr("--repair"));
  EXPECT_EQ(run_printed_command(merged.out).exit_code, 0);
  EXPECT_EQ(run_generate_dataset({"--merge", data_}).exit_code, 0);
  expect_as_of_one_machine(data_);
}

}  // namespace
}  // namespace tubebin::testing
