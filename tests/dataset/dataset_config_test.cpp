#include "tubebin/dataset/dataset_config.hpp"

#include <gmock/gmock.h>

#include "support/program.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/dataset/scene_id.hpp"

namespace tubebin::dataset {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string source_file(const std::string& path) { return TUBEBIN_SOURCE_DIR "/" + path; }

/// The message with which a configuration of that text is refused, the file's name cut to "c.yaml".
std::string refusal_of(const std::string& text) {
  const testing::TemporaryFolder folder;
  const std::string path = folder / "c.yaml";
  testing::write_text(path, text);
  try {
    load_config(path);
  } catch (const ConfigError& error) {
    std::string message = error.what();
    for (std::size_t at = message.find(path); at != std::string::npos; at = message.find(path))
      message.replace(at, path.size(), "c.yaml");
    return message;
  }
  return "(accepted)";
}

TEST(DatasetConfig, RefusesFilesThatAreNoConfiguration) {
  EXPECT_THROW(load_config("/no/such/file.yaml"), ConfigError);
  EXPECT_THAT(refusal_of(""), HasSubstr("empty"));
  EXPECT_THAT(refusal_of("# nothing but a comment\n"), HasSubstr("empty"));
  EXPECT_THAT(refusal_of("set: [A\n"), AllOf(StartsWith("c.yaml:"), HasSubstr("not valid YAML")));
  EXPECT_THAT(refusal_of("- a\n- b\n"), HasSubstr("mapping"));
  EXPECT_THAT(refusal_of(std::string("\x89PNG\r\n\x1a\n\0\0\0", 11)), StartsWith("c.yaml"));
}

TEST(DatasetConfig, SuggestsTheKeyThatWasMeant) {
  EXPECT_THAT(refusal_of("tube:\n  raduis: 0.01\n"),
              AllOf(StartsWith("c.yaml:2:3: tube.raduis: unknown key"), HasSubstr("did you mean 'radius'?")));
  EXPECT_THAT(refusal_of("case: 3\n"), HasSubstr("did you mean 'cases'?"));
}

TEST(DatasetConfig, RefusesDepthImagesOfCloudsThatAreNone) {
  EXPECT_EQ(refusal_of("output: {depth_image: true}\nscanner: {region: full}\n"), "(accepted)");
  EXPECT_THAT(refusal_of("output: {depth_image: true}\nscanner: {region: tubes}\n"),
              AllOf(StartsWith("c.yaml:1:23: output.depth_image: 'true'"), HasSubstr("scanner.region 'tubes'")));
  EXPECT_THAT(refusal_of("scanners: [{}, {position: [0, 1, 2]}]\noutput: {depth_image: true}\n"),
              AllOf(StartsWith("c.yaml:2:23: output.depth_image: 'true'"), HasSubstr("`scanners`")));
}

TEST(DatasetConfig, NamesPlaceKeyValueAndWhatIsValid) {
  EXPECT_THAT(refusal_of("tube:\n  radius: thick\n"),
              AllOf(StartsWith("c.yaml:2:11: tube.radius: 'thick'"), HasSubstr("0.0005")));
  EXPECT_THAT(refusal_of("tube: {radius: .nan}\n"), StartsWith("c.yaml:1:16: tube.radius: '.nan'"));
  EXPECT_THAT(refusal_of("tube: {radius: .inf}\n"), StartsWith("c.yaml:1:16: tube.radius: '.inf'"));
  EXPECT_THAT(refusal_of("tube: {radius: -1}\n"), StartsWith("c.yaml:1:16: tube.radius: '-1'"));
  EXPECT_THAT(refusal_of("tubes: [1, 0]\n"), StartsWith("c.yaml:1:12: tubes[1]: '0'"));
  EXPECT_THAT(refusal_of("tubes: []\n"), StartsWith("c.yaml:1:8: tubes"));
  EXPECT_THAT(refusal_of("cases: 2.5\n"), StartsWith("c.yaml:1:8: cases: '2.5'"));
  EXPECT_THAT(refusal_of("seed: -3\n"), StartsWith("c.yaml:1:7: seed: '-3'"));
  EXPECT_THAT(refusal_of("scanner: {region: all}\n"), HasSubstr("bin, full, tubes"));
  EXPECT_THAT(refusal_of("output: {format: las}\n"), HasSubstr("ply_binary"));
  EXPECT_THAT(refusal_of("set: ../A\n"), StartsWith("c.yaml:1:6: set: '../A'"));
  EXPECT_THAT(refusal_of("tube:\n"), HasSubstr("tube: 'nothing' is not valid; valid: a mapping"));
}

TEST(DatasetConfig, RefusesValuesThatContradictEachOther) {
  EXPECT_THAT(refusal_of("tube:\n  cylinder_length_min: 0.1\n"),
              AllOf(StartsWith("c.yaml:2:24: tube.cylinder_length_min: "), HasSubstr("length = 0.5 m")));
  EXPECT_THAT(refusal_of("tube: {cylinder_count_min: 20}\n"), HasSubstr("tube.cylinder_count_max"));
  EXPECT_THAT(refusal_of("tube: {bend_angle_min_deg: 40}\n"), HasSubstr("tube.bend_angle_max_deg"));
  EXPECT_THAT(refusal_of("scanner: {range_max: 0.05}\n"), StartsWith("c.yaml:1:22: scanner.range_max"));
  EXPECT_THAT(refusal_of("scanner: {effects: {dropouts: {tube_reflectivity_max: 0.2, tube_reflectivity_min: 0.3}}}\n"),
              HasSubstr("scanner.effects.dropouts.tube_reflectivity_max: 0.2 is below"));
  EXPECT_THAT(refusal_of("scanner: {effects: {projector: {enabled: true, position: [0, 0, 3]}}}\n"),
              HasSubstr("scanner.effects.projector.focus_distance: 2 m is not beyond"));
  EXPECT_THAT(refusal_of("bin: {width: 0.1, corner_radius: 0.06}\n"),
              AllOf(HasSubstr("bin.corner_radius: 0.06 m"), HasSubstr("up to 0.05 m")));
  EXPECT_THAT(refusal_of("surroundings: {boxes: {count_max: 2}}\n"),
              AllOf(StartsWith("c.yaml:1:35: surroundings.boxes.count_max: 2 need a table"),
                    HasSubstr("surroundings.table.length")));
  EXPECT_THAT(refusal_of("surroundings: {table: {length: 1, width: 0.2}}\n"),
              AllOf(HasSubstr("surroundings.table.width: 0.2 m"), HasSubstr("at least 0.41 m")));
  EXPECT_THAT(refusal_of("surroundings: {table: {length: 1, width: 1}, boxes: {size_min: 0.3}}\n"),
              HasSubstr("surroundings.boxes.size_max: 0.2 is below surroundings.boxes.size_min = 0.3"));
  EXPECT_THAT(refusal_of("surroundings: {table: {length: 2, width: 2, thickness: 0.1}}\n"
                         "scanner: {position: [0.9, 0.9, -0.05]}\n"),
              AllOf(StartsWith("c.yaml:2:21: scanner.position"),
                    HasSubstr("[0.9, 0.9, -0.05] m is inside the table of the surroundings")));
  EXPECT_THAT(refusal_of("surroundings: {table: {length: {uniform: [1.0, 2.0]}, width: 2}}\n"
                         "scanner: {position: [0.9, 0.9, -0.03]}\n"),
              HasSubstr("inside the table of the surroundings"))
      << "some of the tables that may be drawn reach it";
  EXPECT_THAT(refusal_of("surroundings: {table: {length: 1, width: 1}, cylinders: {count_min: 3}}\n"),
              HasSubstr("surroundings.cylinders.count_max: 0 is below"));
  EXPECT_THAT(refusal_of("tubes: [1, 5, 1]\n"), StartsWith("c.yaml:1:8: tubes: 1 stands in the list twice"));
}

TEST(DatasetConfig, RefusesAConfigurationOfAnotherVersion) {
  EXPECT_THAT(refusal_of("tool_version: 99.0\n"), AllOf(HasSubstr("99.0"), HasSubstr(tool_version())));
  EXPECT_EQ(refusal_of(fmt::format("tool_version: {}\n", tool_version())), "(accepted)");
}

TEST(DatasetConfig, ReadsBackWhatItWrites) {
  DatasetConfig config = load_config(source_file("config/published_b.yaml"));
  config.seed = 18446744073709551615ULL;
  const testing::TemporaryFolder folder;
  testing::write_text(folder / "config.yaml", format_config(config));
  EXPECT_EQ(format_config(load_config(folder / "config.yaml")), format_config(config));
  EXPECT_TRUE(differences(config, load_config(folder / "config.yaml")).empty());
}

TEST(DatasetConfig, NamesDifferencesButNotHowMuchIsWanted) {
  DatasetConfig there;
  DatasetConfig here;
  here.cases = 99;
  here.tubes = {4};
  here.attempts_max = 1;
  EXPECT_TRUE(differences(there, here).empty());
  here.seed = 2;
  here.tube.radius = 0.01;
  EXPECT_THAT(differences(there, here), ElementsAre("seed: 1 there, 2 here", "tube.radius: 0.0125 there, 0.01 here"));
}

TEST(DatasetConfig, CommittedFilesHoldThePapersAndThePublishedValues) {
  const DatasetConfig a = load_config(source_file("config/set_a.yaml"));
  const DatasetConfig b = load_config(source_file("config/set_b.yaml"));
  const DatasetConfig published_a = load_config(source_file("config/published_a.yaml"));
  const DatasetConfig published_b = load_config(source_file("config/published_b.yaml"));
  EXPECT_EQ(list_scenes(a).size(), 320u);  // Section 6.1
  EXPECT_EQ(a.tube.bend_angle_max_deg, 30.0);
  EXPECT_EQ(b.tube.bend_angle_max_deg, 45.0);
  EXPECT_EQ(b.bin, a.bin);
  EXPECT_EQ(published_b.bin.length, 0.80);
  EXPECT_EQ(published_b.tube.bend_angle_min_deg, 5.0);
  EXPECT_EQ(published_a.tube.mass, 0.5);
  EXPECT_EQ(published_b.set, "B");
  EXPECT_NO_THROW(load_config(source_file("config/physics_paper.yaml")));
  for (const DatasetConfig& paper : {a, b, published_a, published_b}) EXPECT_FALSE(paper.scanner.effects.any());
  const DatasetConfig cell = load_config(source_file("config/cell.yaml"));
  EXPECT_EQ(cell.tube.length, a.tube.length);
  EXPECT_EQ(cell.scanner.region, scene::ScanRegion::full);
  const DatasetConfig zivid_like = load_config(source_file("config/scanner_zivid_like.yaml"));
  EXPECT_TRUE(zivid_like.scanner.effects.any());
  for (const std::string& difference : differences(a, zivid_like))
    EXPECT_THAT(difference, ::testing::AnyOf(StartsWith("scanner.effects."), StartsWith("output.clean_cloud")));
}

TEST(DatasetConfig, EveryKeyOfACommittedFileHasAComment) {
  for (const auto& entry : std::filesystem::directory_iterator(source_file("config"))) {
    std::istringstream lines(testing::read_text(entry.path()));
    for (std::string line; std::getline(lines, line);) {
      const bool sets_a_value = !line.starts_with('#') && line.find(": ") != std::string::npos;
      EXPECT_TRUE(!sets_a_value || line.find('#') != std::string::npos) << entry.path() << ": " << line;
    }
  }
}

TEST(DatasetConfig, DocumentationIsTheOneThatTheProgramPrints) {
  EXPECT_EQ(testing::read_text(source_file("docs/configuration.md")), document_config())
      << "make it anew: generate_dataset --config-reference > docs/configuration.md";
}

TEST(TubeCounts, AreNumbersAndRanges) {
  EXPECT_THAT(parse_tube_counts("1,5,10-12"), ElementsAre(1, 5, 10, 11, 12));
  for (const char* bad : {"", ",", "1,", "a", "3-", "-3", "5-2", "0", "1.5", "99999", "1 2"})
    EXPECT_THROW(parse_tube_counts(bad), ConfigError) << bad;
}

TEST(Shards, TakeEverySceneOnceTogether) {
  DatasetConfig config;
  config.tubes = {1, 7};
  config.cases = 5;
  std::vector<SceneId> together;
  for (const char* text : {"1/3", "2/3", "3/3"})
    for (const SceneId& id : list_scenes(config, jobs::parse_shard(text))) together.push_back(id);
  EXPECT_THAT(together, ::testing::UnorderedElementsAreArray(list_scenes(config)));
  EXPECT_EQ(list_scenes(config).back().name(), "A7/005");
  for (const char* bad : {"", "1", "0/3", "4/3", "1/0", "1/3x", "-1/2", "a/b", "1/"})
    EXPECT_THROW(jobs::parse_shard(bad), ConfigError) << bad;
}

}  // namespace
}  // namespace tubebin::dataset
