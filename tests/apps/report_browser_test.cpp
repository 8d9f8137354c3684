/// The report in a real browser: no errors, and everything that is to be there is there.
#include <gmock/gmock.h>

#include <algorithm>

#include "support/browser.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/random.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin {
namespace {

using ::testing::AllOf;
using testing::CommandResult;
using ::testing::HasSubstr;

/// Adds the scene's cloud to the data set, and kept clouds to the runs of the scene, with some points mislabelled.
void keep_clouds(const std::filesystem::path& folder, const std::string& scene_name, int tubes,
                 const std::vector<double>& ratios) {
  const scene::SceneRecord record = testing::synthetic_scene(scene_name, tubes, 5);
  const cloud::Cloud full = scan::scan(record.scene).cloud;
  const std::string bytes = cloud::format_cloud(full, cloud::CloudFormat::pcd_binary);
  testing::write_text(folder / "dataset" / scene_name / "cloud.pcd", bytes);
  for (const auto& run : std::filesystem::directory_iterator(folder / "results" / scene_name)) {
    const std::string path = (run.path() / "result.json").string();
    nlohmann::json result = nlohmann::json::parse(read_file(path));
    result["cloud_xxh128"] = record_bytes(bytes).xxh128;
    testing::write_text(path, result.dump(1));
  }
  Random random(1);
  for (const std::string method : {"centerline", "region_growing"})
    for (const double ratio : ratios) {
      cloud::Cloud filtered;
      for (std::size_t i = 0; i < full.size(); ++i) {
        if (full.labels[i] == 0 || !cloud::is_finite(full.points[i]) || random.uniform(0.0, 1.0) > ratio) continue;
        filtered.points.push_back(full.points[i]);
        filtered.labels.push_back(full.labels[i]);
      }
      filtered.width = static_cast<std::uint32_t>(filtered.size());
      cloud::Cloud labeled = filtered;
      for (std::size_t i = 0; i < labeled.size(); ++i)
        if (labeled.points[i].x() > 0.15F) labeled.labels[i] = labeled.labels[i] % 2 == 0 ? 0 : 1;
      const auto run = folder / "results" / scene_name / fmt::format("{}_{}", method, ratio);
      cloud::write_cloud((run / "filtered.pcd").string(), filtered, cloud::CloudFormat::pcd_binary);
      cloud::write_cloud((run / "labeled.pcd").string(), labeled, cloud::CloudFormat::pcd_binary);
    }
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

class ReportInBrowser : public testing::BrowserTest {
 protected:
  void SetUp() override {
    BrowserTest::SetUp();
    if (IsSkipped()) return;
    testing::SyntheticSweep sweep;
    sweep.tubes = {1, 5, 10, 20};
    sweep.ratios = {0.1, 0.3, 1.0};
    sweep.methods = {"centerline", "region_growing"};
    testing::write_synthetic_sweep(folder_.path(), sweep);
    keep_clouds(folder_.path(), "B20/001", 20, sweep.ratios);
    const CommandResult evaluated = testing::run_command(fmt::format(
        "{0}/evaluate {1}/results --paper --html {1}/report.html 2>&1", TUBEBIN_BIN_DIR, folder_.path().string()));
    ASSERT_EQ(evaluated.exit_code, 0) << evaluated.output;
  }

  nlohmann::json evaluate_in_frame(int width, const std::string& script) const {
    return BrowserTest::evaluate_in_frame("report.html", width, script);
  }
};

TEST_F(ReportInBrowser, OpensWithoutErrorsAndShowsEverything) {
  const std::string html = dom("report.html");
  EXPECT_THAT(html,
              AllOf(HasSubstr("id=\"figure_8\""), HasSubstr("id=\"figure_9\""), HasSubstr("id=\"table_2_centerline\""),
                    HasSubstr("id=\"table_2_region_growing\""), HasSubstr("Claims of Section 6.2, region_growing")));
  for (const char* id : {"verdict", "worst", "scenes", "measures", "plots", "paper", "tables", "configuration"})
    EXPECT_EQ(count(html, fmt::format("<section id=\"{}\"", id)), 1U) << id;
  EXPECT_EQ(count(html, "<svg"), 4U);
  EXPECT_EQ(count(html, "class=\"verdict\""), 2U);       // one a method
  EXPECT_EQ(count(html, "data:image/png;base64,"), 6U);  // the one scene whose clouds were kept, by two methods
  EXPECT_EQ(count(html, "3D view: arrows"), 2U);
}

TEST_F(ReportInBrowser, FitsAPhoneAndShowsAPictureEarly) {
  const std::string script =
      "result.width = page.documentElement.scrollWidth;"
      "result.picture = page.querySelector('img').getBoundingClientRect().top;";
  EXPECT_LE(evaluate_in_frame(390, script)["width"], 390);
  EXPECT_LT(evaluate_in_frame(390, script)["picture"], 1500);
  EXPECT_LT(evaluate_in_frame(1280, script)["picture"], 1000);
}

TEST_F(ReportInBrowser, IsAccessible) { expect_accessible("report.html"); }

TEST_F(ReportInBrowser, SortsAndFiltersScenes) {
  const nlohmann::json seen = evaluate_in_frame(1280, R"js(
  const table = page.querySelector(".scenes table");
  const column = (i) => [...table.tBodies[0].rows].filter((row) => !row.hidden).map((row) => row.cells[i].textContent);
  result.first = column(4);
  const buttons = table.querySelectorAll("th button");
  buttons[2].click();
  result.up = column(2);
  buttons[2].click();
  result.down = column(2);
  result.order = table.querySelectorAll("th")[2].getAttribute("aria-sort");
  const input = page.querySelector(".filter input");
  input.value = "b20 region";
  input.dispatchEvent(new Event("input"));
  result.filtered = column(0).concat(column(1));
  result.shown = page.querySelector(".filter output").textContent;)js");
  EXPECT_TRUE(std::is_sorted(seen["first"].begin(), seen["first"].end()));
  const auto tubes = [&](const char* order) {
    std::vector<int> values;
    for (const std::string text : seen[order]) values.push_back(std::stoi(text));
    return values;
  };
  EXPECT_THAT(tubes("up"), ::testing::WhenSorted(::testing::ContainerEq(tubes("up"))));
  EXPECT_THAT(tubes("down"), ::testing::WhenSortedBy(std::greater<>(), ::testing::ContainerEq(tubes("down"))));
  EXPECT_EQ(tubes("up").front(), 1);
  EXPECT_EQ(seen["order"], "descending");
  EXPECT_EQ(seen["filtered"], (nlohmann::json{"B20/001", "B20/002", "region_growing", "region_growing"}));
  EXPECT_EQ(seen["shown"], "2 of 32");
}

}  // namespace
}  // namespace tubebin
