// model_tubes as a user runs it: single clouds, data sets, bad input.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/commands.hpp"
#include "support/program.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/results/model_cloud.hpp"
#include "tubebin/results/results_folder.hpp"

namespace tubebin::testing {

using namespace results;
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string kScene = TUBEBIN_SOURCE_DIR "/data/A10/003";

ProgramResult model_tubes(const std::vector<std::string>& arguments) {
  std::vector<std::string> command = {TUBEBIN_BIN_DIR "/model_tubes"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return Program(command).wait();
}

class ModelTubes : public ::testing::Test {
 protected:
  /// A data set of one scene, as often as there are names.
  std::string make_dataset(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      fs::create_directories(folder_ / ("dataset/" + name));
      for (const char* file : {"cloud.pcd", "scene.json"})
        fs::copy_file(kScene + "/" + file, folder_ / ("dataset/" + name + "/" + file));
    }
    return folder_ / "dataset";
  }

  TemporaryFolder folder_;
};

class ModelTubesOf : public ModelTubes {
 protected:
  /// Generates the cases, and returns what the modeler makes of them when nothing is told.
  std::vector<evaluation::RunScore> model(const std::string& config, const std::string& seed, const std::string& tubes,
                                          const std::string& cases) {
    const std::string data = folder_ / "data", results = folder_ / "results";
    EXPECT_EQ(run_generate_dataset({TUBEBIN_SOURCE_DIR "/config/" + config, "--output", data, "--seed", seed, "--tubes",
                                    tubes, "--cases", cases})
                  .exit_code,
              0);
    EXPECT_EQ(model_tubes({data, "--output", results, "--quiet"}).exit_code, 0);
    return read_results({results}, {}).runs;
  }
};

/// Bits of a tube that look like one of another radius took up to two fifths of the thin ones' points.
TEST_F(ModelTubesOf, HosesOfThreeRadiiTellsThemApart) {
  const auto runs = model("hoses.yaml", "5", "10", "3");
  ASSERT_EQ(runs.size(), 3u);
  for (const evaluation::RunScore& run : runs) EXPECT_GE(run.micro_recall, 0.98) << run.key.scene;
}

/// Among pipes and forks, a length of 0.94 m was taken for common to all, which joined each fork to another tube.
TEST_F(ModelTubesOf, SeveralShapesBelievesNoLengthThatExplainsLessThanAnyLengthsDo) {
  const auto runs = model("mixed.yaml", "901", "15", "9");
  ASSERT_EQ(runs.size(), 9u);
  for (const evaluation::RunScore& run : runs) EXPECT_GE(run.micro_recall, 0.9) << run.key.scene;
}

/// The stem and the two arms of the last one's fork, which are as long together, were taken for tubes of a common length.
TEST_F(ModelTubesOf, SeveralShapesTakesNoForkApart) {
  const auto runs = model("mixed.yaml", "4242", "5", "12");
  ASSERT_EQ(runs.size(), 12u);
  for (const evaluation::RunScore& run : runs) EXPECT_GE(run.micro_recall, 0.9) << run.key.scene;
}

TEST_F(ModelTubes, WritesBothCloudsAndTheModelOfOne) {
  const std::string out = folder_ / "out";
  const ProgramResult result = model_tubes({kScene + "/cloud.pcd", "--output", out, "--ratio", "0.3"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_THAT(result.out, HasSubstr("10 tubes"));
  const cloud::Cloud filtered = cloud::read_cloud(out + "/filtered.pcd"),
                     labeled = cloud::read_cloud(out + "/labeled.pcd");
  ASSERT_EQ(filtered.size(), labeled.size());
  const json model = json::parse(read_text(out + "/model.json"));
  EXPECT_EQ(model["filtered_points"].get<std::size_t>(), filtered.size());
  EXPECT_EQ(model["tubes"].size(), 10u);
  EXPECT_GT(model["seconds"]["total"].get<double>(), 0.0);
  const cloud::Cloud input = cloud::read_cloud(kScene + "/cloud.pcd");
  std::map<std::tuple<float, float, float>, cloud::Color> color_at;
  for (std::size_t i = 0; i < input.size(); ++i)
    if (cloud::is_finite(input.points[i]))
      color_at[{input.points[i].x(), input.points[i].y(), input.points[i].z()}] = input.colors[i];
  for (std::size_t i = 0; i < filtered.size(); ++i) {
    const cloud::Point& p = filtered.points[i];
    ASSERT_EQ(p, labeled.points[i]);
    ASSERT_EQ(filtered.colors[i], color_at.at({p.x(), p.y(), p.z()}));
    const auto label = labeled.labels[i];
    const std::string color = fmt::format("#{:06x}", labeled.colors[i]);
    ASSERT_EQ(color, label == 0 ? "#000000" : model["tubes"][label - 1]["color"].get<std::string>());
  }
  expect_schema("model.schema.json", out + "/model.json");
}

TEST_F(ModelTubes, ColoursAndLabelsMakeNoDifference) {
  CloudToModel input = read_cloud_to_model(kScene + "/cloud.pcd");
  const modeling::ModelingResult with = model_cloud(input, ModelConfig{});
  input.cloud.colors.clear();
  input.cloud.labels.clear();
  const modeling::ModelingResult without = model_cloud(input, ModelConfig{});
  EXPECT_EQ(with.labels, without.labels);
}

TEST_F(ModelTubes, ACloudGivesTheSameModelWhateverTheCores) {
  // Without scene.json, so that the background is found, too.
  const std::string cloud = folder_ / "cloud.pcd";
  fs::copy_file(kScene + "/cloud.pcd", cloud);
  std::vector<json> models;
  for (const char* cores : {"1", "2", "8"}) {
    const std::string out = folder_ / cores;
    const ProgramResult result = model_tubes({cloud, "--output", out, "--full", "--quiet", "--jobs", cores});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    models.push_back(json::parse(read_text(out + "/model.json")));
    models.back().erase("seconds");
    EXPECT_EQ(models.back(), models.front());
    EXPECT_EQ(read_text(out + "/full.pcd"), read_text(folder_ / "1/full.pcd"));
  }
}

TEST_F(ModelTubes, ADataSetGivesTheSameBytesWhateverTheJobs) {
  const std::string dataset = make_dataset({"A10/001", "A10/002"});
  const std::string one = folder_ / "one", two = folder_ / "two";
  const std::vector<std::string> rest = {"--ratios", "0.1,0.3", "--quiet", "--jobs"};
  for (const auto& [out, jobs] : {std::pair(one, "1"), std::pair(two, "2")}) {
    std::vector<std::string> arguments = {dataset, "--output", out};
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    arguments.push_back(jobs);
    const ProgramResult result = model_tubes(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.error;
  }
  for (const char* run : {"A10/001/centerline_0.1", "A10/001/centerline_0.3", "A10/002/centerline_0.1"})
    for (const char* file : {"/result.json", "/model.json"})
      EXPECT_EQ(read_text(one + "/" + run + file), read_text(two + "/" + run + file)) << run << file;
  const json result = json::parse(read_text(one + "/A10/002/centerline_0.3/result.json"));
  std::size_t sum = 0;
  for (const json& entry : result["contingency"]) sum += entry[2].get<std::size_t>();
  EXPECT_EQ(sum, result["filtered_points"].get<std::size_t>());
  EXPECT_EQ(result["truth_labels"].size(), 11u);
}

TEST_F(ModelTubes, GoesOnWhereItStoppedAndRefusesOtherOptions) {
  const std::string dataset = make_dataset({"A10/001"});
  const std::string out = folder_ / "out";
  ASSERT_EQ(model_tubes({dataset, "--output", out, "--ratios", "0.1", "--quiet"}).exit_code, 0);
  const ProgramResult more = model_tubes({dataset, "--output", out, "--ratios", "0.1,0.2", "--quiet"});
  EXPECT_EQ(more.exit_code, 0) << more.error;
  EXPECT_THAT(more.out, HasSubstr("1 there before"));
  const ProgramResult other = model_tubes({dataset, "--output", out, "--ratios", "0.1", "--seed", "9", "--quiet"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.error, HasSubstr("seed"));
}

TEST_F(ModelTubes, NamesTheOptionsThatResultsWereMadeWithOtherwise) {
  const std::string dataset = make_dataset({"A10/001"});
  const std::string out = folder_ / "out";
  ASSERT_EQ(model_tubes({dataset, "--output", out, "--ratios", "0.1", "--quiet"}).exit_code, 0);
  const ProgramResult other =
      model_tubes({dataset, "--output", out, "--ratios", "0.1", "--radius", "0.012", "--quiet"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.error, HasSubstr("other options (radius: estimated and radius: 0.012); choose another --output"));
  // An option that a later version no longer has.
  json index = json::parse(read_text(out + "/index.json"));
  index["options"]["region_growing"]["gone"] = 0.2;
  write_text(out + "/index.json", index.dump());
  EXPECT_THAT(model_tubes({dataset, "--output", out, "--ratios", "0.1", "--quiet"}).error,
              HasSubstr("other options (region_growing.gone: 0.2 and region_growing.gone: none)"));
  EXPECT_EQ(Program({program_path("evaluate"), out}).wait().exit_code, 0);
}

TEST_F(ModelTubes, ABadCloudIsReportedAndTheOthersAreDone) {
  const std::string dataset = make_dataset({"A10/001", "A10/002"});
  write_text(dataset + "/A10/001/cloud.pcd", "no cloud");
  const std::string out = folder_ / "out";
  const ProgramResult result = model_tubes({dataset, "--output", out, "--ratios", "0.1", "--quiet"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.error, HasSubstr("A10/001"));
  EXPECT_TRUE(fs::exists(out + "/A10/002/centerline_0.1/result.json"));
  EXPECT_FALSE(fs::exists(out + "/A10/001/centerline_0.1"));
  EXPECT_EQ(json::parse(read_text(out + "/failures.jsonl"))["scene"], "A10/001");
}

TEST_F(ModelTubes, NamesWhatIsWrongWithAFile) {
  const std::string header = "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
  const auto pcd = [&](const std::string& points, const std::string& data) {
    return header + "WIDTH " + points + "\nHEIGHT 1\nVIEWPOINT 0 0 2 1 0 0 0\nPOINTS " + points + "\nDATA ascii\n" +
           data;
  };
  const std::vector<std::pair<std::string, std::string>> files = {
      {"empty.pcd", ""},
      {"text.pcd", "these are words\n"},
      {"lying.pcd", pcd("4000000000", "0 0 0.1\n")},
      {"none.pcd", pcd("0", "")},
      {"nan.pcd", pcd("2", "nan nan nan\nnan nan nan\n")},
      {"truncated.pcd", read_text(kScene + "/cloud.pcd").substr(0, 5000)}};
  for (const auto& [name, text] : files) {
    write_text(folder_ / name, text);
    const ProgramResult result = model_tubes({folder_ / name, "--output", folder_ / "out"});
    EXPECT_EQ(result.exit_code, 1) << name;
    EXPECT_THAT(result.error, HasSubstr(name));
  }
  const ProgramResult missing = model_tubes({folder_ / "missing.pcd", "--output", folder_ / "out"});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.error, HasSubstr("missing.pcd"));

  const std::string dataset = make_dataset({"A10/001"});
  write_text(dataset + "/A10/001/scene.json", "{");
  const ProgramResult scene = model_tubes({dataset + "/A10/001/cloud.pcd", "--output", folder_ / "out"});
  EXPECT_EQ(scene.exit_code, 1);
  EXPECT_THAT(scene.error, HasSubstr("scene.json"));
}

TEST_F(ModelTubes, RefusesOptionsThatCannotBeMeant) {
  const std::string cloud = kScene + "/cloud.pcd", out = folder_ / "out";
  const std::vector<std::vector<std::string>> wrong = {
      {cloud, "--output", out, "--ratio", "0"},     {cloud, "--output", out, "--ratio", "1.5"},
      {cloud, "--output", out, "--radius", "-1"},   {cloud, "--output", out, "--method", "magic"},
      {cloud, "--output", out, "--ratios", "0.5"},  {cloud, "--output", out, "--config", folder_ / "none.yaml"},
      {kScene, "--output", out, "--ratios", "2:1"}, {cloud}};
  for (const auto& arguments : wrong) {
    const ProgramResult result = model_tubes(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments.back();
    EXPECT_FALSE(result.error.empty());
  }
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace tubebin::testing
