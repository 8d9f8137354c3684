// Clouds modelled in shards, of data sets that were made in shards, loose or packed.
#include <nlohmann/json.hpp>

#include "dataset/shards.hpp"
#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/scene/dataset_files.hpp"

namespace tubebin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

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
  for (const char* shard : {"1/3", "2/3", "3/3"}) {
    const ProgramResult result = model(one_machine_, results_, {"--shard", shard});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_THAT(result.error, AllOf(HasSubstr("of 3 (--shard): "), HasSubstr("of 8 clouds, ")));
  }
  EXPECT_EQ(result_files(results_), result_files(one_results_));
  EXPECT_EQ(read_text(results_ + "/index.json"), read_text(one_results_ + "/index.json"));
}

TEST_F(ModelShards, AreEvaluatedFromFoldersOfTheirOwn) {
  std::vector<std::string> folders;
  for (const char* shard : {"1", "2", "3"}) {
    folders.push_back(folder_ / (std::string("results_") + shard));
    ASSERT_EQ(model(one_machine_, folders.back(), {"--shard", std::string(shard) + "/3"}).exit_code, 0);
  }
  const auto evaluate = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--format", "json", "--quiet"});
    return run_program("evaluate", arguments);
  };
  const ProgramResult together = evaluate(folders);
  const ProgramResult alone = evaluate({one_results_});
  EXPECT_EQ(together.exit_code, 0) << together.error;
  EXPECT_EQ(recall_of(together.out), recall_of(alone.out));
  // Without a shard, exactly its runs are missing.
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
  // Those of another seed are a setting of their own, and both lack runs.
  const std::string other = folder_ / "other_seed";
  ASSERT_EQ(model(one_machine_, other, {"--shard", "2/3", "--seed", "9"}).exit_code, 0);
  const ProgramResult mixed = evaluate({folders[1], other});
  EXPECT_EQ(mixed.exit_code, 3);
  EXPECT_THAT(mixed.error, AllOf(HasSubstr(" seed: 1 "), HasSubstr(" seed: 9 "), HasSubstr("--resume " + other)));
}

TEST_F(ModelShards, AreResumedByTheirOwnOptionsAlone) {
  const std::string index = read_text(one_results_ + "/index.json");
  const std::vector<std::vector<std::string>> others = {{"--radius", "0.01"},
                                                        {"--bin-pose", "0,0,0.1,0,0,0"},
                                                        {"--viewpoint", "0,0,2"},
                                                        {"--up", "0,1,0"},
                                                        {"--crop", "-1,-1,-1,1,1,1"},
                                                        {"--scale", "0.001"},
                                                        {"--full"}};
  for (std::vector<std::string> arguments : others) {
    SCOPED_TRACE(arguments.front());
    arguments.insert(arguments.end(), {"--resume", one_results_});
    const ProgramResult resumed = run_program("model_tubes", arguments);
    EXPECT_EQ(resumed.exit_code, 2);
    EXPECT_THAT(resumed.error, HasSubstr("--resume takes the options of the modeller from " + one_results_));
  }
  EXPECT_EQ(read_text(one_results_ + "/index.json"), index);
  // Nor does a second call that is not told to resume mix them in, or leave out what a data set has no place for.
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"--viewpoint", "0,0,2"}, {"--up", "0,1,0"}, {"--crop", "-1,-1,-1,1,1,1"}, {"--full"}, {"--scale", "0.001"}})
    EXPECT_EQ(model(one_machine_, one_results_, arguments).exit_code, 2) << arguments.front();
  EXPECT_EQ(read_text(one_results_ + "/index.json"), index);
}

TEST_F(ModelShards, ReadPacksDirectly) {
  for (const char* shard : {"1/2", "2/2"}) ASSERT_EQ(generate(data_, {"--shard", shard, "--pack"}).exit_code, 0);
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
  EXPECT_EQ(of_one_pack.size(), 2 * 2 * dataset::list_scenes(dataset::read_dataset_config(data_), {2, 2}).size());
  for (const auto& [name, bytes] : of_one_pack) EXPECT_EQ(bytes, result_files(one_results_).at(name)) << name;
  // Any program's labels can be scored on packs.
  fs::create_directories(folder_ / "labels");
  const scene::DatasetFiles files(data_);
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
