/// The report in a real browser: no errors, and everything that is to be there is there.
#include <gmock/gmock.h>

#include <algorithm>

#include "support/commands.hpp"
#include "support/synthetic_results.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/random.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin {
namespace {

using ::testing::AllOf;
using testing::CommandResult;
using ::testing::HasSubstr;
using ::testing::Not;

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

TEST(ReportInBrowser, OpensWithoutErrorsAndShowsEverything) {
  if (std::system("command -v chromium >/dev/null 2>&1") != 0) GTEST_SKIP() << "no chromium here";
  testing::TemporaryFolder folder;
  testing::SyntheticSweep sweep;
  sweep.tubes = {1, 5, 10, 20};
  sweep.ratios = {0.1, 0.3, 1.0};
  sweep.methods = {"centerline", "region_growing"};
  testing::write_synthetic_sweep(folder.path(), sweep);
  keep_clouds(folder.path(), "B20/001", 20, sweep.ratios);
  const std::string report = (folder.path() / "report.html").string();
  const CommandResult evaluated = testing::run_command(
      fmt::format("{}/evaluate {}/results --paper --html {} 2>&1", TUBEBIN_BIN_DIR, folder.path().string(), report));
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.output;

  const std::string log = (folder.path() / "browser.log").string();
  const CommandResult dom =
      testing::run_command(fmt::format("chromium --headless --no-sandbox --disable-gpu --disable-quic "
                                       "--no-first-run --disable-background-networking "
                                       "--disable-component-update --disable-sync --user-data-dir={}/profile "
                                       "--enable-logging=stderr --dump-dom "
                                       "file://{} 2>{}",
                                       folder.path().string(), report, log));
  ASSERT_EQ(dom.exit_code, 0) << read_file(log);
  EXPECT_THAT(read_file(log), Not(HasSubstr("CONSOLE")));
  EXPECT_THAT(dom.output, AllOf(HasSubstr("id=\"figure_8\""), HasSubstr("id=\"figure_9\""),
                                HasSubstr("id=\"table_2_centerline\""), HasSubstr("id=\"table_2_region_growing\""),
                                HasSubstr("id=\"configuration\""), HasSubstr("Claims of Section 6.2, region_growing")));
  EXPECT_EQ(count(dom.output, "<svg"), 4U);
  EXPECT_EQ(count(dom.output, "data:image/png;base64,"), 6U);  // the one scene whose clouds were kept, by two methods
  EXPECT_EQ(count(dom.output, "<section"), 6U);
}

}  // namespace
}  // namespace tubebin
