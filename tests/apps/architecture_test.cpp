// The modules' one-way order, and libraries that stay behind the public headers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "support/program.hpp"

namespace tubebin::testing {
namespace {

const std::map<std::string, std::set<std::string>> kMayInclude = {
    {"core", {}},
    {"tube", {"core"}},
    {"cloud", {"core"}},
    {"jobs", {"core"}},
    {"scene", {"core", "tube", "cloud"}},
    {"physics", {"core", "tube", "cloud", "scene"}},
    {"scan", {"core", "tube", "cloud", "scene"}},
    {"render", {"core", "tube", "cloud", "scene"}},
    {"modeling", {"core", "tube", "cloud", "scene"}},
    {"evaluation", {"core", "tube", "cloud", "scene"}},
    {"dataset", {"core", "tube", "cloud", "jobs", "scene", "physics", "scan", "render"}},
    {"results", {"core", "tube", "cloud", "jobs", "scene", "modeling", "evaluation"}},
    {"export",
     {"core", "tube", "cloud", "jobs", "scene", "physics", "scan", "render", "modeling", "evaluation", "dataset",
      "results"}},
    {"calibration", {"core", "tube", "cloud", "jobs", "scene", "modeling", "evaluation", "results"}}};

std::vector<std::string> included_by(const fs::path& file) {
  static const std::regex include(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<std::string> included;
  std::istringstream lines(read_text(file));
  std::smatch match;
  for (std::string line; std::getline(lines, line);)
    if (std::regex_search(line, match, include)) included.push_back(match[1]);
  return included;
}

/// "tubebin/scene/scene.hpp" and "scene/json_reader.hpp" -> "scene"; "" for anything else.
std::string module_of(std::string header) {
  if (header.starts_with("tubebin/")) header = header.substr(8);
  const std::string first = header.substr(0, header.find('/'));
  return kMayInclude.contains(first) && header.find('/') != std::string::npos ? first : "";
}

TEST(Architecture, ModulesIncludeOnlyWhatIsBelowThem) {
  int includes = 0;
  for (const std::string tree : {"include/tubebin", "src"})
    for (const auto& [module, allowed] : kMayInclude) {
      const fs::path folder = fs::path(TUBEBIN_SOURCE_DIR) / tree / module;
      if (!fs::exists(folder)) continue;
      for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
        for (const std::string& header : included_by(entry.path())) {
          const std::string other = module_of(header);
          includes += other.empty() ? 0 : 1;
          EXPECT_TRUE(other.empty() || other == module || allowed.contains(other))
              << entry.path() << " includes " << header;
        }
    }
  EXPECT_GT(includes, 50);
}

TEST(Architecture, PublicHeadersHideTheLibrariesBehindTheStages) {
  const std::regex hidden(R"(^(ode/|embree\d/|GL/|pcl/|nlohmann/|yaml-cpp/|png\.h|CLI/))");
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(TUBEBIN_SOURCE_DIR "/include")) {
    if (!entry.is_regular_file()) continue;
    for (const std::string& header : included_by(entry.path()))
      EXPECT_FALSE(std::regex_search(header, hidden)) << entry.path() << " includes " << header;
  }
}

// An error of the standard library names neither program nor what would be right: core/path_status.hpp does.
TEST(Architecture, NoCallThrowsTheStandardLibrarysFileErrors) {
  const std::regex call(R"(\b(?:fs|filesystem)::\w*(?:exists|is_\w+|iterator|file_size|status|director\w+|absolute|)"
                        R"(relative|canonical|current_path|copy\w*|rename|remove\w*|equivalent)\w* ?(?:\w+)?\()");
  int calls = 0;
  for (const char* tree : {"/src", "/apps", "/include", "/python/src"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(std::string(TUBEBIN_SOURCE_DIR) + tree)) {
      if (!entry.is_regular_file()) continue;
      std::istringstream lines(read_text(entry.path()));
      for (std::string line; std::getline(lines, line);) {
        if (!std::regex_search(line, call)) continue;
        ++calls;
        EXPECT_NE(line.find("error)"), std::string::npos) << entry.path() << ": " << line;
      }
    }
  EXPECT_GT(calls, 5);
}

/// The shared libraries that the program loads when it starts.
std::string loaded_by(const std::string& program) {
  return Program({"/usr/bin/ldd", program_path(program)}).wait().out;
}

TEST(Architecture, ProgramsThatReadCloudsLoadNoSimulator) {
  EXPECT_THAT(loaded_by("generate_dataset"), ::testing::HasSubstr("libode"));
  for (const std::string program : {"model_tubes", "evaluate", "calibrate_modeler", "view"})
    for (const std::string library : {"libode", "libembree", "OSMesa"})
      EXPECT_THAT(loaded_by(program), ::testing::Not(::testing::HasSubstr(library))) << program;
}

// Libraries whose symbols take the loader many times as long as all others together.
TEST(Architecture, ProgramsStartWithoutLargeLibraries) {
  for (const std::string program :
       {"generate_dataset", "model_tubes", "calibrate_modeler", "export_dataset", "evaluate", "view"})
    for (const std::string library : {"libpcl", "libvtk", "libQt", "libOSMesa", "libLLVM", "libboost"})
      EXPECT_THAT(loaded_by(program), ::testing::Not(::testing::HasSubstr(library))) << program;
}

}  // namespace
}  // namespace tubebin::testing
