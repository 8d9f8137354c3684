// The report's points: labelled by the tubes in model.json as the modeler labelled them, and modelled again where not.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "results/result_files.hpp"
#include "support/program.hpp"
#include "tubebin/modeling/model_json.hpp"
#include "tubebin/results/labelled_points.hpp"
#include "tubebin/results/model_cloud.hpp"
#include "tubebin/results/results_folder.hpp"

namespace tubebin::results {
namespace {

using nlohmann::json;
using testing::read_text;
namespace fs = std::filesystem;

TEST(LabelsOfModelJson, AreTheModelers) {
  for (const std::string scene : {"A10/003", "B10/002"})
    for (const modeling::ModelingMethod method : modeling::all_methods())
      for (const BinSource bin : {BinSource::automatic, BinSource::cloud})
        for (const double ratio : {0.3, 1.0}) {
          SCOPED_TRACE(fmt::format("{} {} {} {}", scene, name_of(method), bin == BinSource::cloud, ratio));
          const CloudToModel input = read_cloud_to_model(TUBEBIN_SOURCE_DIR "/data/" + scene + "/cloud.pcd");
          ModelConfig config;
          config.modeling.method = method;
          config.modeling.filtering.ratio = ratio;
          config.bin_source = bin;
          const modeling::ModelingResult modelled = model_cloud(input, config);
          const std::string text = modeling::format_model_json(
              modelled, model_colors(modelled), [&](Fields& fields) { describe(fields, config); }, false);
          const modeling::ModelingResult labelled =
              label_cloud(input, config, parse_labeling_tubes(text, "model.json"));
          EXPECT_GT(modelled.tubes.size(), 5U);
          EXPECT_EQ(labelled.labels, modelled.labels);
          EXPECT_EQ(labelled.source, modelled.source);
        }
}

/// Without its clouds.
class ResultsOfOneScene : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "dataset/A10/003");
    for (const char* file : {"/cloud.pcd", "/scene.json"})
      fs::copy_file(TUBEBIN_SOURCE_DIR "/data/A10/003" + std::string(file),
                    folder_ / ("dataset/A10/003" + std::string(file)));
    const testing::ProgramResult made =
        testing::Program({testing::program_path("model_tubes"), folder_ / "dataset", "--output", folder_ / "results",
                          "--ratios", "0.3", "--quiet"})
            .wait();
    ASSERT_EQ(made.exit_code, 0) << made.error;
  }
  std::string file(const char* name) const { return folder_ / ("results/A10/003/centerline_0.3/" + std::string(name)); }
  std::optional<evaluation::LabelledPoints> points() const {
    return labelled_points(read_results({folder_ / "results"}, {}).runs.at(0));
  }
  void edit(const char* name, const std::function<void(json&)>& change) const {
    json content = json::parse(read_text(file(name)));
    change(content);
    testing::write_text(file(name), content.dump());
  }

  testing::TemporaryFolder folder_;
};

TEST_F(ResultsOfOneScene, AreModelledAgainWhereTheTubesAreOthers) {
  const auto before = points();
  ASSERT_TRUE(before);
  edit("model.json", [](json& model) {
    for (json& cylinder : model["tubes"][0]["cylinders"])
      for (const char* end : {"start", "end"}) cylinder[end][0] = cylinder[end][0].get<double>() + 0.005;
  });
  const CloudToModel input = read_cloud_to_model(folder_ / "dataset/A10/003/cloud.pcd");
  ModelConfig config;
  config.modeling.filtering.ratio = 0.3;
  const auto moved = label_cloud(input, config, parse_labeling_tubes(read_text(file("model.json")), "model.json"));
  EXPECT_NE(std::ranges::count(moved.labels, 1U), std::ranges::count(before->predicted, 1U));
  const auto after = points();
  ASSERT_TRUE(after);
  EXPECT_EQ(after->predicted, before->predicted);
  EXPECT_EQ(after->truth, before->truth);
}

TEST_F(ResultsOfOneScene, HaveNoPointsWhereTheirCountsAreOthers) {
  edit("result.json", [](json& result) {
    result["contingency"][0][2] = result["contingency"][0][2].get<int>() + 1;
    result["contingency"][1][2] = result["contingency"][1][2].get<int>() - 1;
  });
  EXPECT_FALSE(points());
}

TEST(LabelsOfModelJson, KnowBalls) {
  const std::string text =
      R"({"tubes": [{"radius": 0.02, "cylinders": [], "joints": [{"position": [1, 2, 3], "radius": 0.02}]}]})";
  const auto tubes = parse_labeling_tubes(text, "model.json");
  ASSERT_EQ(tubes.size(), 1U);
  EXPECT_TRUE(tubes[0].is_ball());
  EXPECT_EQ(tubes[0].paths.at(0).nodes, std::vector{Vec3(1, 2, 3)});
  const auto lines = parse_model_tubes(text, "model.json");
  ASSERT_EQ(lines.at(0).centerline.size(), 1U);
  EXPECT_EQ(lines[0].centerline[0].start, Vec3(1, 2, 3));
  EXPECT_EQ(lines[0].centerline[0].end, Vec3(1, 2, 3));
}

TEST(LabelsOfModelJson, NeedTubesWithASurface) {
  const std::string text = R"({"tubes": [{"radius": 0, "cylinders": []}]})";
  try {
    parse_labeling_tubes(text, "model.json");
    ADD_FAILURE() << "no error";
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find("model.json: /tubes/0/radius"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace tubebin::results
