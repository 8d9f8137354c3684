// Results and exports belong to the data set that they were made from, and truth comes from the data set.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/program.hpp"
#include "tubebin/cloud/cloud_io.hpp"

namespace tubebin::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class StaleResults : public ::testing::Test {
 protected:
  StaleResults() {
    write_text(folder_ / "v.yaml",
               "set: V\ntubes: [2]\ncases: 2\ntube: {length: 0.2, cylinder_count_max: 6}\n"
               "scanner: {width: 480, height: 300}\n");
    generate("1");
  }

  void generate(const std::string& seed) const {
    fs::remove_all(data_);
    ASSERT_EQ(run("generate_dataset", {folder_ / "v.yaml", "--output", data_, "--seed", seed}).exit_code, 0);
  }
  ProgramResult run(const std::string& program, std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), program_path(program));
    arguments.emplace_back("--quiet");
    return Program(arguments).wait();
  }
  ProgramResult model() const { return run("model_tubes", {data_, "--output", results_}); }
  ProgramResult evaluate() const { return run("evaluate", {results_, "--format", "json"}); }
  static double recall(const ProgramResult& result) {
    return json::parse(result.out)["groups"][0]["micro_recall"].get<double>();
  }

  TemporaryFolder folder_;
  std::string data_ = folder_ / "data", results_ = folder_ / "results";
};

TEST_F(StaleResults, OfADataSetThatWasMadeAnewAreRefusedAndMadeAnew) {
  ASSERT_EQ(model().exit_code, 0);
  EXPECT_EQ(evaluate().exit_code, 0);
  EXPECT_THAT(model().out, HasSubstr("0 made"));
  generate("99");
  const ProgramResult stale = evaluate();
  EXPECT_EQ(stale.exit_code, 1);
  EXPECT_THAT(stale.error, HasSubstr("was made from another scene.json"));
  EXPECT_THAT(model().out, HasSubstr("2 made"));
  const ProgramResult evaluated = evaluate();
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.error;
  const std::string fresh = folder_ / "fresh";
  ASSERT_EQ(run("model_tubes", {data_, "--output", fresh}).exit_code, 0);
  for (const char* scene : {"V2/001", "V2/002"})
    for (const char* file : {"result.json", "model.json"}) {
      const std::string name = fmt::format("/{}/centerline_1/{}", scene, file);
      EXPECT_EQ(read_text(results_ + name), read_text(fresh + name)) << name;
    }
}

TEST_F(StaleResults, OfACloudThatChangedAlone) {
  ASSERT_EQ(model().exit_code, 0);
  fs::remove(data_ + "/manifest.jsonl");  // nothing tells the hashes but the files
  fs::copy_file(data_ + "/V2/002/cloud.pcd", data_ + "/V2/001/cloud.pcd", fs::copy_options::overwrite_existing);
  EXPECT_EQ(evaluate().exit_code, 1);
  EXPECT_THAT(model().out, HasSubstr("1 made"));
}

TEST_F(StaleResults, ACloudThatTheManifestDoesNotRecordIsNamed) {
  fs::copy_file(data_ + "/V2/002/cloud.pcd", data_ + "/V2/001/cloud.pcd", fs::copy_options::overwrite_existing);
  const ProgramResult modelled = model();
  EXPECT_EQ(modelled.exit_code, 3);
  EXPECT_THAT(modelled.error, HasSubstr("V2/001/cloud.pcd: has hash"));
  EXPECT_EQ(run("export_dataset", {data_, "--format", "npz", "--output", folder_ / "npz"}).exit_code, 3);
}

TEST_F(StaleResults, TheSceneJsonOfAnotherSceneIsNamed) {
  ASSERT_EQ(model().exit_code, 0);
  fs::remove(data_ + "/manifest.jsonl");
  fs::copy_file(data_ + "/V2/002/scene.json", data_ + "/V2/001/scene.json", fs::copy_options::overwrite_existing);
  const ProgramResult evaluated = evaluate();
  EXPECT_EQ(evaluated.exit_code, 1);
  EXPECT_THAT(evaluated.error, HasSubstr("was made from another scene.json"));
  EXPECT_EQ(model().exit_code, 3);
  const ProgramResult exported = run("export_dataset", {data_, "--format", "coco", "--output", folder_ / "coco"});
  EXPECT_EQ(exported.exit_code, 3);
  EXPECT_THAT(exported.error, HasSubstr("/id: \"V2/002\" is not valid"));
}

TEST_F(StaleResults, AnExportOfOtherCloudsIsRefused) {
  const auto exported = [&] {
    return run("export_dataset", {data_, "--format", "npz", "--output", folder_ / "npz"}).exit_code;
  };
  ASSERT_EQ(exported(), 0);
  EXPECT_EQ(exported(), 0);
  generate("99");
  EXPECT_EQ(exported(), 2);
}

TEST_F(StaleResults, AFolderThatIsRemovedMeanwhileIsNoSuccess) {
  int live = 0;
  write_text(folder_ / "many.yaml",
             "set: K\ntubes: [1]\ncases: 60\ntube: {length: 0.2}\nscanner: {width: 160, height: 100}\n");
  for (int round = 0; round < 8; ++round) {
    const std::string data = folder_ / "many";
    Program program({program_path("generate_dataset"), folder_ / "many.yaml", "--output", data, "-q", "--jobs", "2"});
    while (program.running() && !fs::exists(data + "/manifest.jsonl")) continue;
    std::error_code ignored;
    while (program.running() && fs::exists(data)) fs::remove_all(data, ignored);
    const ProgramResult result = program.wait();
    live += result.exit_code != 0;
    if (fs::exists(data + "/manifest.jsonl")) {
      EXPECT_EQ(read_text(data + "/manifest.jsonl").find('\0'), std::string::npos);
    }
    if (result.exit_code == 0) {
      EXPECT_EQ(run("generate_dataset", {"--verify", data}).exit_code, 0);
    }
    fs::remove_all(data);
  }
  EXPECT_GT(live, 0) << "no run was still alive when its folder went";
}

class ForgedPredictions : public StaleResults {
 protected:
  /// Writes the scene's prediction: what `filter` keeps of its cloud, labelled as `label` says.
  template <typename Filter, typename Forge>
  void predict(const std::string& scene, Filter filter, Forge forge) const {
    const cloud::Cloud cloud = cloud::read_cloud(data_ + "/" + scene + "/cloud.pcd");
    cloud::Cloud filtered;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (cloud::is_finite(cloud.points[i]) && cloud.labels[i] != 0 && filter(i)) {
        filtered.points.push_back(cloud.points[i]);
        filtered.labels.push_back(cloud.labels[i]);
      }
    filtered.width = static_cast<std::uint32_t>(filtered.size());
    cloud::Cloud labeled = filtered;
    forge(filtered, labeled);
    fs::create_directories(predictions_ + "/" + scene);
    write_cloud(predictions_ + "/" + scene + "/filtered.pcd", filtered, cloud::CloudFormat::pcd_binary);
    write_cloud(predictions_ + "/" + scene + "/labeled.pcd", labeled, cloud::CloudFormat::pcd_binary);
  }
  ProgramResult score() const { return run("evaluate", {data_, "--predictions", predictions_, "--format", "json"}); }

  std::string predictions_ = folder_ / "predictions";
};

TEST_F(ForgedPredictions, AFewChosenPointsAreNoPrediction) {
  const auto honest = [](cloud::Cloud&, cloud::Cloud&) {};
  for (const char* scene : {"V2/001", "V2/002"})
    predict(
        scene, [](std::size_t i) { return i % 3 == 0; }, honest);
  const ProgramResult good = score();
  ASSERT_EQ(good.exit_code, 0) << good.error;
  EXPECT_EQ(recall(good), 1.0);
  const json notes = json::parse(good.out)["notes"];
  ASSERT_FALSE(notes.empty());
  EXPECT_THAT(notes.back().get<std::string>(), ::testing::ContainsRegex("3[0-9]\\.[0-9] % of the tubes' points"));

  int kept = 0;
  predict(
      "V2/001", [&](std::size_t) { return kept++ < 5; }, honest);
  const ProgramResult few = score();
  EXPECT_EQ(few.exit_code, 1);
  EXPECT_THAT(few.error, HasSubstr("% of the scene's points"));
}

TEST_F(ForgedPredictions, LabelsOfAFilteredCloudAreNotTheTruth) {
  // Both tubes are one, in the prediction and in what it says of the truth.
  for (const char* scene : {"V2/001", "V2/002"})
    predict(
        scene, [](std::size_t) { return true; },
        [](cloud::Cloud& filtered, cloud::Cloud& labeled) {
          for (cloud::Label& label : filtered.labels) label = 1;
          for (cloud::Label& label : labeled.labels) label = 1;
        });
  const ProgramResult result = score();
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_LT(recall(result), 0.9);
}

TEST_F(ForgedPredictions, PointsThatTheSceneDoesNotHaveAreNamed) {
  predict(
      "V2/001", [](std::size_t) { return true; },
      [](cloud::Cloud& filtered, cloud::Cloud& labeled) {
        filtered.points[7].z() += 0.5F;
        labeled.points[7].z() += 0.5F;
      });
  const ProgramResult result = score();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.error, HasSubstr("its point 7 at"));
}

}  // namespace
}  // namespace tubebin::testing
