#include "tubebin/dataset/timing_table.hpp"

#include <gmock/gmock.h>

#include "support/program.hpp"

namespace tubebin::dataset {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Two scenes of five tubes, which took 0.2 s and 0.4 s and their pictures 1 s and 2 s.
std::string table(bool has_previews) {
  testing::TemporaryFolder folder;
  std::vector<SceneId> scenes;
  std::string lines;
  for (const int number : {1, 2}) {
    scenes.push_back({"A", 5, number});
    ManifestRecord record{.id = scenes.back().name(),
                          .tubes = 5,
                          .seed = 1,
                          .rejected = {},
                          .seconds = {{"total", 0.2 * number}},
                          .physics = {},
                          .files = {{"cloud.pcd", {.bytes = 1, .xxh128 = std::string(32, '0')}}}};
    if (has_previews) record.seconds["preview"] = number;
    lines += format_manifest_record(record) + "\n";
  }
  testing::write_text(folder / "manifest.jsonl", lines);
  return format_timing_table(Manifest(folder / ""), scenes, {{5, 6.0}});
}

TEST(TimingTable, ShowsPicturesApart) {
  EXPECT_THAT(table(false), HasSubstr("     5       2     0.300      6.00       20x\n"));
  EXPECT_THAT(table(false), Not(HasSubstr("pictures")));
  EXPECT_THAT(table(true), HasSubstr("     5       2     0.300      6.00       20x     1.500\n"));
}

}  // namespace
}  // namespace tubebin::dataset
