// README's table of results copies the reproduction of the paper, and its claims are tests' names: this holds them to both.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace tubebin::testing {
namespace {

const std::string kRoot = TUBEBIN_SOURCE_DIR;

std::vector<std::string> lines_of(const std::string& path) {
  std::ifstream file(kRoot + "/" + path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  EXPECT_FALSE(lines.empty()) << path;
  return lines;
}

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, separator);) cells.push_back(cell);
  return cells;
}

/// The cells of the first row `| label | ... |` at or after the line that starts with `after`.
std::vector<std::string> markdown_row(const std::string& path, const std::string& label,
                                      const std::string& after = "") {
  bool found = false;
  for (const std::string& line : lines_of(path)) {
    found = found || line.starts_with(after);
    if (!found || !line.starts_with("| " + label + " |")) continue;
    std::vector<std::string> cells;
    for (const std::string& cell : split(line.substr(1), '|')) {
      const std::size_t first = cell.find_first_not_of(' ');
      cells.push_back(first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(' ') + 1 - first));
    }
    return cells;
  }
  ADD_FAILURE() << path << ": has no row '" << label << "'";
  return std::vector<std::string>(5);
}

/// The value as it is written with the decimals that the copy has.
std::string rounded_as(const std::string& copy, const std::string& value) {
  const std::size_t point = copy.find('.');
  return fmt::format("{:.{}f}", std::stod(value), point == std::string::npos ? 0 : copy.size() - point - 1);
}

/// A group's mean of one measure, as docs/reproduction/groups.csv has it.
std::string group_mean(const std::string& group, const std::string& measure) {
  const std::vector<std::string> lines = lines_of("docs/reproduction/groups.csv");
  const std::vector<std::string> names = split(lines.at(0), ',');
  for (const std::string& line : lines) {
    if (!line.starts_with(group + ",")) continue;
    const std::vector<std::string> values = split(line, ',');
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == measure) return values.at(i);
  }
  ADD_FAILURE() << "groups.csv has no " << measure << " of " << group;
  return "nan";
}

TEST(Readme, CopiesTheReproduction) {
  struct Row {
    const char *label, *group, *measure;
  };
  for (const Row& row : {Row{"micro-recall, set B, ratio 0.3: 1 tube", "B,1,0.3", "micro_recall"},
                         {"2 tubes", "B,2,0.3", "micro_recall"},
                         {"10 tubes", "B,10,0.3", "micro_recall"},
                         {"micro-recall, full clouds of set A: 10 tubes", "A,10,1", "micro_recall"},
                         {"20 tubes", "A,20,1", "micro_recall"},
                         {"seconds to model a full cloud of ten tubes", "A,10,1", "seconds"}}) {
    const std::vector<std::string> cells = markdown_row("README.md", row.label);
    const std::map<std::string, std::string> here = {{"region_growing", cells.at(2)}, {"centerline", cells.at(3)}};
    for (const auto& [method, copy] : here)
      EXPECT_EQ(copy, rounded_as(copy, group_mean(fmt::format("{},{}", method, row.group), row.measure)))
          << row.label << ", " << method;
  }
}

TEST(Readme, CopiesTheSecondsOfAScene) {
  const std::vector<std::string> cells = markdown_row("README.md", "seconds to generate a cloud of ten tubes");
  const std::string measured = markdown_row("docs/reproduction.md", "10", "| tubes | A | A paper |").at(1);
  EXPECT_EQ(cells.at(2), measured);
  EXPECT_EQ(cells.at(3), measured);
}

/// Every "Suite.Name" in tests/.
std::set<std::string> names_of_tests() {
  static const std::regex kTest(R"(^TEST(?:_F|_P)?\((\w+), (\w+)\))");
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kRoot + "/tests")) {
    if (entry.path().extension() != ".cpp") continue;
    for (const std::string& line : lines_of(std::filesystem::relative(entry.path(), kRoot)))
      if (std::smatch match; std::regex_search(line, match, kTest)) names.insert(match.str(1) + "." + match.str(2));
  }
  return names;
}

/// README's lines that promise something of every case, and its list of promises, item by item.
std::vector<std::string> claims() {
  static const std::regex kOfEveryCase(R"(\b(any|never|nothing|always)\b)", std::regex::icase);
  std::vector<std::string> claims;
  bool is_code = false, is_item = false;
  for (const std::string& line : lines_of("README.md")) {
    is_code = is_code != line.starts_with("```");
    is_item = line.starts_with("- ") || (is_item && line.starts_with("  "));
    if (line.starts_with("- ")) claims.push_back(line);
    else if (is_item) claims.back() += line;
    if (!is_code && std::regex_search(line, kOfEveryCase)) claims.push_back(line);
  }
  return claims;
}

TEST(Readme, NamesTheTestOfEachClaim) {
  static const std::regex kNames("<!-- test: ([^>]*) -->");
  const std::set<std::string> tests = names_of_tests();
  EXPECT_GE(claims().size(), 10U);
  for (const std::string& claim : claims()) {
    std::smatch match;
    if (!std::regex_search(claim, match, kNames)) {
      ADD_FAILURE() << "README.md: names no test, as in <!-- test: Suite.Name --> at the end of the line: " << claim;
      continue;
    }
    for (const std::string& name : split(match.str(1), ' '))
      EXPECT_TRUE(tests.contains(name)) << "README.md: there is no test " << name << ": " << claim;
  }
}

}  // namespace
}  // namespace tubebin::testing
