// Data sets made in parts: into one folder or several, at once, interrupted, merged, packed. The scenes are those of one
// machine, byte for byte.
#include <gmock/gmock.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "dataset/faults.hpp"
#include "tubebin/core/tar.hpp"
#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/scene/dataset_files.hpp"

namespace tubebin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

ProgramResult run_program(const std::string& name, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), program_path(name));
  return Program(arguments).wait();
}

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

/// What the command printed after "To make exactly what is missing:", with our program for the one on the PATH.
ProgramResult run_printed_command(const std::string& out) {
  const std::string mark = "To make exactly what is missing:\n  ";
  const std::size_t begin = out.find(mark);
  if (begin == std::string::npos) return {};
  const std::string command =
      out.substr(begin + mark.size(), out.find('\n', begin + mark.size()) - begin - mark.size());
  return Program({"/bin/sh", "-c", "PATH=" TUBEBIN_BIN_DIR ":$PATH; exec " + command}).wait();
}

class Shards : public ::testing::Test {
 protected:
  Shards() {
    write_text(config_, quick_config());
    EXPECT_EQ(generate(one_machine_).exit_code, 0);
    expected_ = scene_files(one_machine_);
  }

  std::vector<std::string> command(const std::string& output, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {config_, "--output", output, "--jobs", "2"});
    return more;
  }
  ProgramResult generate(const std::string& output, std::vector<std::string> more = {}) const {
    return run_generate_dataset(command(output, std::move(more)));
  }

  void expect_as_of_one_machine(const std::string& data) const {
    EXPECT_EQ(scene_files(data), expected_);
    EXPECT_EQ(read_text(data + "/config.yaml"), read_text(one_machine_ + "/config.yaml"));
    EXPECT_FALSE(fs::exists(data + "/manifest.parts"));
    const Manifest manifest(data), other(one_machine_);
    ASSERT_EQ(manifest.records().size(), other.records().size());
    for (const auto& [id, record] : manifest.records()) {
      EXPECT_EQ(record.files, other.find(id)->files);
      EXPECT_EQ(record.seed, other.find(id)->seed);
    }
    EXPECT_EQ(run_generate_dataset({"--verify", data}).exit_code, 0);
  }

  TemporaryFolder folder_;
  std::string config_ = folder_ / "quick.yaml";
  std::string one_machine_ = folder_ / "one";
  std::string data_ = folder_ / "shared data";  // with a space, for the commands that are printed
  std::map<std::string, std::string> expected_;
};

TEST_F(Shards, WriteOneFolderAtOnce) {
  std::vector<std::unique_ptr<Program>> parts;
  for (const char* part : {"1/3", "2/3", "3/3"}) {
    std::vector<std::string> arguments = command(data_, {"--shard", part});
    arguments.insert(arguments.begin(), program_path("generate_dataset"));
    parts.push_back(std::make_unique<Program>(arguments));
  }
  for (const auto& part : parts) {
    const ProgramResult result = part->wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_THAT(result.error, AllOf(HasSubstr("of 3 (--shard): "), HasSubstr("of 8 scenes, ")));
  }
  EXPECT_EQ(Manifest(data_).records().size(), 8u);  // from the parts' files
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
    EXPECT_THAT(generate(data_).error, HasSubstr("Part 2 of 2 (SLURM_ARRAY_TASK_ID=12, SLURM_ARRAY_TASK_MIN=10, "));
    EXPECT_EQ(generate(data_, {"--shard-count", "3"}).exit_code, 2);
  }
  {
    const Variable index("JOB_COMPLETION_INDEX", "0");
    EXPECT_EQ(generate(data_).exit_code, 2);
    const Variable count("TUBEBIN_SHARD_COUNT", "2");
    EXPECT_THAT(generate(data_).error, HasSubstr("Part 1 of 2 (JOB_COMPLETION_INDEX=0, shard count 2): "));
  }
  EXPECT_EQ(scene_files(data_), expected_);
}

TEST_F(Shards, GoOnWhereTheyWereKilled) {
  for (int round = 0; round < 3; ++round) {
    std::vector<std::string> arguments = command(data_, {"--shard", "1/2"});
    arguments.insert(arguments.begin(), program_path("generate_dataset"));
    Program part(arguments);
    wait_until([&] { return !part.running() || Manifest(data_).records().size() > static_cast<std::size_t>(round); });
    kill(part.process(), SIGKILL);
    part.wait();
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
  const auto of = [&](const std::string& part) {
    return list_scenes(
        [&] {
          DatasetConfig config = read_dataset_config(one_machine_);
          return config;
        }(),
        parse_shard(part));
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
  const FolderLock part((fs::create_directories(data_), data_), FolderLock::Kind::part);
  EXPECT_EQ(generate(data_, {"--shard", "1/2"}).exit_code, 0);
  EXPECT_EQ(generate(data_).exit_code, 2);
  EXPECT_EQ(run_generate_dataset({"--merge", data_}).exit_code, 2);
}

class Merge : public Shards {
 protected:
  std::string part(int i) const { return folder_ / ("part_" + std::to_string(i)); }
  void make_part(int i, std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--shard", std::to_string(i) + "/3"});
    ASSERT_EQ(generate(part(i), more).exit_code, 0);
  }
  ProgramResult merge(const std::vector<int>& parts) {
    std::vector<std::string> arguments = {"--merge", data_};
    for (const int i : parts) arguments.push_back(part(i));
    return run_generate_dataset(arguments);
  }
};

TEST_F(Merge, JoinsFoldersOfParts) {
  for (int i = 1; i <= 3; ++i) make_part(i);
  const auto before = scene_files(part(2));
  const ProgramResult merged = merge({1, 2, 3});
  EXPECT_EQ(merged.exit_code, 0) << merged.out << merged.error;
  expect_as_of_one_machine(data_);
  EXPECT_EQ(scene_files(part(2)), before);
  // Links, not copies.
  EXPECT_EQ(fs::hard_link_count(data_ + "/Q3/001/cloud.pcd"), 2u);
  EXPECT_EQ(merge({3, 1, 2}).exit_code, 0);
  expect_as_of_one_machine(data_);
}

TEST_F(Merge, NamesWhatIsMissingAndHowToMakeJustThat) {
  make_part(1);
  make_part(3);
  const std::size_t there = scene_files(part(1)).size() / 3 + scene_files(part(3)).size() / 3;
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
  EXPECT_TRUE(fs::exists(data_ + "/manifest.parts"));  // other parts may still be at work
  EXPECT_EQ(run_printed_command(merged.out).exit_code, 0);
  EXPECT_EQ(run_generate_dataset({"--merge", data_}).exit_code, 0);
  expect_as_of_one_machine(data_);
}

TEST_F(Merge, RefusesFoldersOfAnotherSeedOrConfiguration) {
  make_part(1);
  make_part(2, {"--seed", "6"});
  const ProgramResult merged = merge({1, 2});
  EXPECT_EQ(merged.exit_code, 2);
  EXPECT_THAT(merged.error, AllOf(HasSubstr(part(1)), HasSubstr(part(2)), HasSubstr("seed: 5 there, 6 here")));
  EXPECT_FALSE(fs::exists(data_));
  EXPECT_EQ(run_generate_dataset({"--merge", data_, folder_ / "nowhere"}).exit_code, 1);
}

TEST_F(Merge, FindsAByteThatFlipped) {
  for (int i = 1; i <= 3; ++i) make_part(i);
  const std::string scene = list_scenes(read_dataset_config(part(2)), {2, 3}).front().name();
  std::string bytes = read_text(part(2) + "/" + scene + "/cloud.pcd");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_text(part(2) + "/" + scene + "/cloud.pcd", bytes);
  const ProgramResult merged = merge({1, 2, 3});
  EXPECT_EQ(merged.exit_code, 3);
  EXPECT_THAT(merged.out, AllOf(HasSubstr(part(2) + "/" + scene + ": cloud.pcd has hash"), HasSubstr("7 of 8 scenes")));
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

class Packs : public Shards {
 protected:
  /// Files of all scenes, loose or packed, by the names that they have loose.
  static std::map<std::string, std::string> all_files(const std::string& dataset) {
    const DatasetFiles files(dataset);
    std::map<std::string, std::string> found;
    for (const std::string& scene : files.scenes())
      for (const char* file : {"cloud.pcd", "scene.json", "tubes.txt"})
        found[scene + "/" + file] = files.read(scene, file);
    return found;
  }
};

TEST_F(Packs, HoldTheSameBytesInOneFileAPart) {
  for (const char* part : {"1/2", "2/2"}) ASSERT_EQ(generate(data_, {"--shard", part, "--pack"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(data_ + "/packs/00001-of-00002.tar"));
  EXPECT_TRUE(fs::is_empty(data_ + "/Q1"));
  EXPECT_EQ(all_files(data_), expected_);
  EXPECT_EQ(run_generate_dataset({"--verify", data_}).exit_code, 0);
  // Any order of making gives the same tar.
  ASSERT_EQ(run_generate_dataset({config_, "--output", folder_ / "again", "--jobs", "1", "--shard", "2/2", "--pack"})
                .exit_code,
            0);
  EXPECT_EQ(read_text(folder_ / "again/packs/00002-of-00002.tar"), read_text(data_ + "/packs/00002-of-00002.tar"));
  // Again: nothing is left to do.
  const std::string tar = read_text(data_ + "/packs/00001-of-00002.tar");
  EXPECT_THAT(generate(data_, {"--shard", "1/2", "--pack"}).error, HasSubstr("0 made"));
  EXPECT_EQ(read_text(data_ + "/packs/00001-of-00002.tar"), tar);
  const ProgramResult listed = Program({"/bin/tar", "--list", "--file", data_ + "/packs/00001-of-00002.tar"}).wait();
  EXPECT_EQ(listed.exit_code, 0) << listed.error;
  EXPECT_THAT(listed.out, HasSubstr(".cloud.pcd\n"));
}

TEST_F(Packs, GoOnWhereTheyWereKilled) {
  std::vector<std::string> arguments = command(data_, {"--cases", "40", "--pack"});
  arguments.insert(arguments.begin(), program_path("generate_dataset"));
  for (std::size_t goal = 10; goal < 60; goal += 10) {
    Program program(arguments);
    wait_until([&] { return !program.running() || Manifest(data_).records().size() > goal; });
    kill(program.process(), SIGKILL);
    program.wait();
    wait_until([&] { return processes_of(data_).empty(); });
  }
  ASSERT_EQ(Program(arguments).wait().exit_code, 0);
  ASSERT_EQ(generate(folder_ / "undisturbed", {"--cases", "40", "--pack"}).exit_code, 0);
  EXPECT_EQ(read_text(data_ + "/packs/00001-of-00001.tar"),
            read_text(folder_ / "undisturbed/packs/00001-of-00001.tar"));
  EXPECT_TRUE(fs::is_empty(data_ + "/Q1"));
}

TEST_F(Packs, AreMergedAndCompleted) {
  ASSERT_EQ(generate(folder_ / "first", {"--shard", "1/3", "--pack"}).exit_code, 0);
  ASSERT_EQ(generate(folder_ / "third", {"--shard", "3/3", "--pack"}).exit_code, 0);
  const ProgramResult merged = run_generate_dataset({"--merge", data_, folder_ / "first", folder_ / "third"});
  EXPECT_EQ(merged.exit_code, 3) << merged.error;
  EXPECT_EQ(run_printed_command(merged.out).exit_code, 0);
  EXPECT_EQ(all_files(data_), expected_);
  const ProgramResult again = run_generate_dataset({"--merge", data_, folder_ / "first", folder_ / "third"});
  EXPECT_EQ(again.exit_code, 0) << again.out << again.error;
  EXPECT_EQ(run_generate_dataset({"--verify", data_}).exit_code, 0);
}

TEST_F(Packs, OfOneSharedFolderAreMerged) {
  for (const char* part : {"2/3", "1/3", "3/3"}) ASSERT_EQ(generate(data_, {"--shard", part, "--pack"}).exit_code, 0);
  const ProgramResult merged = run_generate_dataset({"--merge", data_});
  EXPECT_EQ(merged.exit_code, 0) << merged.out << merged.error;
  EXPECT_FALSE(fs::exists(data_ + "/manifest.parts"));
  EXPECT_EQ(all_files(data_), expected_);
  EXPECT_THAT(generate(data_).error, HasSubstr("8 were there before"));
  EXPECT_EQ(std::distance(fs::directory_iterator(data_ + "/packs"), {}), 3);
}

TEST_F(Packs, ADamagedSceneIsFoundAndRepaired) {
  ASSERT_EQ(generate(data_, {"--pack"}).exit_code, 0);
  const std::string pack = data_ + "/packs/00001-of-00001.tar";
  std::string bytes = read_text(pack);
  const TarMember member = list_tar(pack)[3];
  bytes[member.offset + member.bytes / 2] = static_cast<char>(bytes[member.offset + member.bytes / 2] ^ 1);
  write_text(pack, bytes);
  EXPECT_THAT(run_generate_dataset({"--verify", data_}).out, HasSubstr("1 damaged"));
  EXPECT_EQ(run_generate_dataset({"--verify", data_, "--repair"}).exit_code, 0);
  EXPECT_EQ(run_generate_dataset({"--verify", data_}).exit_code, 0);
  EXPECT_EQ(all_files(data_), expected_);
}

/// Results but for their times.
std::map<std::string, std::string> result_files(const std::string& results) {
  std::map<std::string, std::string> files = scene_files(results);
  std::erase_if(files, [](const auto& file) { return file.first.ends_with("/times.json"); });
  return files;
}

/// Tables without those of times.
std::string recall_of(const std::string& json_text) {
  nlohmann::json groups = nlohmann::json::parse(json_text);
  std::string text;
  for (const auto& group : groups.at("groups")) text += group.at("micro_recall").dump() + "\n";
  return text;
}

class ModelShards : public Shards {
 protected:
  ModelShards() { EXPECT_EQ(model(one_machine_, one_results_).exit_code, 0); }
  ProgramResult model(const std::string& dataset, const std::string& results,
                      std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {dataset, "--output", results, "--radius", "0.0125", "--tube-length", "0.2", "--ratios",
                               "0.3,1", "--jobs", "2"});
    return run_program("model_tubes", more);
  }
  std::string one_results_ = folder_ / "one_results";
  std::string results_ = folder_ / "results";
};

TEST_F(ModelShards, MakeTheResultsOfOneMachineInOneFolder) {
  for (const char* part : {"1/3", "2/3", "3/3"}) {
    const ProgramResult result = model(one_machine_, results_, {"--shard", part});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_THAT(result.error, AllOf(HasSubstr("of 3 (--shard): "), HasSubstr("of 8 clouds, ")));
  }
  EXPECT_EQ(result_files(results_), result_files(one_results_));
  EXPECT_EQ(read_text(results_ + "/index.json"), read_text(one_results_ + "/index.json"));
}

TEST_F(ModelShards, AreEvaluatedFromFoldersOfTheirOwn) {
  std::vector<std::string> folders;
  for (const char* part : {"1", "2", "3"}) {
    folders.push_back(folder_ / (std::string("results_") + part));
    ASSERT_EQ(model(one_machine_, folders.back(), {"--shard", std::string(part) + "/3"}).exit_code, 0);
  }
  const auto evaluate = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--format", "json", "--quiet"});
    return run_program("evaluate", arguments);
  };
  const ProgramResult together = evaluate(folders);
  const ProgramResult alone = evaluate({one_results_});
  EXPECT_EQ(together.exit_code, 0) << together.error;
  EXPECT_EQ(recall_of(together.out), recall_of(alone.out));
  // Without a part, exactly its runs are missing.
  const ProgramResult two = evaluate({folders[0], folders[2]});
  EXPECT_EQ(two.exit_code, 3);
  EXPECT_THAT(two.error, HasSubstr(fmt::format("{} runs are not there yet", result_files(folders[1]).size() / 2)));
  // The command that is printed makes exactly these, into the first folder.
  const ProgramResult resumed = run_printed_command(two.error);
  EXPECT_EQ(resumed.exit_code, 0) << resumed.error;
  auto completed = result_files(folders[0]);
  completed.merge(result_files(folders[2]));
  EXPECT_EQ(completed, result_files(one_results_));
  const ProgramResult complete = evaluate({folders[0], folders[2]});
  EXPECT_EQ(complete.exit_code, 0) << complete.error;
  EXPECT_EQ(recall_of(complete.out), recall_of(alone.out));
  // Parts of another seed don't belong to them.
  const std::string other = folder_ / "other_seed";
  ASSERT_EQ(model(one_machine_, other, {"--shard", "2/3", "--seed", "9"}).exit_code, 0);
  const ProgramResult mixed = evaluate({folders[1], other});
  EXPECT_EQ(mixed.exit_code, 1);
  EXPECT_THAT(mixed.error, AllOf(HasSubstr(other), HasSubstr("another version, seed or options")));
}

TEST_F(ModelShards, ReadPacksDirectly) {
  for (const char* part : {"1/2", "2/2"}) ASSERT_EQ(generate(data_, {"--shard", part, "--pack"}).exit_code, 0);
  ASSERT_EQ(model(data_, results_).exit_code, 0);
  EXPECT_EQ(result_files(results_), result_files(one_results_));
  const ProgramResult packed =
      run_program("evaluate", {results_, "--format", "json", "--html", folder_ / "report.html"});
  const ProgramResult loose = run_program("evaluate", {one_results_, "--format", "json"});
  EXPECT_EQ(packed.exit_code, 0) << packed.error;
  EXPECT_EQ(recall_of(packed.out), recall_of(loose.out));
  EXPECT_THAT(packed.error, Not(HasSubstr("scene.json")));  // ground truth was found in the packs
  // A pack alone is a data set too.
  ASSERT_EQ(model(data_ + "/packs/00002-of-00002.tar", folder_ / "of_one_pack").exit_code, 0);
  auto of_one_pack = result_files(folder_ / "of_one_pack");
  EXPECT_EQ(of_one_pack.size(), 2 * 2 * list_scenes(read_dataset_config(data_), {2, 2}).size());
  for (const auto& [name, bytes] : of_one_pack) EXPECT_EQ(bytes, result_files(one_results_).at(name)) << name;
  // Any program's labels can be scored on packs.
  fs::create_directories(folder_ / "labels");
  const DatasetFiles files(data_);
  for (const std::string& scene : files.scenes()) {
    fs::create_directories(fs::path(folder_ / "labels/" + scene).parent_path());
    write_text(folder_ / ("labels/" + scene + ".pcd"), files.read(scene, "cloud.pcd"));
  }
  const ProgramResult scored =
      run_program("evaluate", {data_, "--predictions", folder_ / "labels", "--field", "label", "--format", "json"});
  EXPECT_EQ(scored.exit_code, 0) << scored.error;
  EXPECT_THAT(scored.out, HasSubstr("\"micro_recall\""));
}

}  // namespace
}  // namespace tubebin::testing
