// Numbers on the command line that are none: the message names the option, the word, and what would be right.
#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

#include "support/program.hpp"

namespace tubebin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct WrongNumber {
  const char* program;
  const char* option;
  const char* word;
  const char* right;
};

constexpr WrongNumber kWrong[] = {
    {"model_tubes", "--scale", "mm", "a number above 0, like 0.001"},
    {"model_tubes", "--scale", "0", "a number above 0, like 0.001"},
    {"model_tubes", "--scale", "inf", "a number above 0, like 0.001"},
    {"model_tubes", "--seed", "-3", "a whole number from 0"},
    {"model_tubes", "--radius", "8mm", "a number is needed"},
    {"model_tubes", "--tube-length", "10mm", "a number is needed"},
    {"model_tubes", "--bend-radius", "2cm", "a number is needed"},
    {"model_tubes", "--up", "1,2,x", "a number is needed"},
    {"model_tubes", "--cases", "-5", "1 to 1000000"},
    {"generate_dataset", "--seed", "99999999999999999999", "a whole number from 0"},
    {"generate_dataset", "--seed", "1e3", "a whole number from 0"},
    {"calibrate_modeler", "--seed", "1.5", "a whole number from 0"},
    {"calibrate_modeler", "--budget", "inf", "1.0"},
    {"evaluate", "--jobs", "0", "1 to 1024"},
    {"export_dataset", "--jobs", "all", "1 to 1024"},
};

TEST(CommandLine, SaysWhatNumberWouldBeRight) {
  for (const WrongNumber& wrong : kWrong) {
    SCOPED_TRACE(std::string(wrong.program) + " " + wrong.option + " " + wrong.word);
    const ProgramResult result = Program({program_path(wrong.program), wrong.option, wrong.word}).wait();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.error, AllOf(HasSubstr(wrong.option), HasSubstr(wrong.word), HasSubstr(wrong.right)));
    EXPECT_LT(result.error.size(), 200u);
  }
}

TEST(CommandLine, HelpIsInWords) {
  for (const std::string program :
       {"generate_dataset", "model_tubes", "calibrate_modeler", "export_dataset", "evaluate", "view"}) {
    SCOPED_TRACE(program);
    const ProgramResult result = Program({program_path(program), "--help"}).wait();
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.out, HasSubstr("\nUsage: " + program + " [OPTIONS]"));
    for (const char* notation : {"INT", "FLOAT", "TEXT", " in [", "REQUIRED", "Excludes", "Needs", "e+0", " x 3"})
      EXPECT_THAT(result.out, ::testing::Not(HasSubstr(notation)));
    const std::size_t options = result.out.find("Options:");
    std::istringstream lines(result.out.substr(options, result.out.find("\n\n", options) - options));
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 111u) << line;
  }
  EXPECT_THAT(Program({program_path("export_dataset"), "--help"}).wait().out,
              AllOf(HasSubstr("bop|coco|npz|ply|sdf"), HasSubstr("1 to 1024; default ")));
}

TEST(CommandLine, AWrongCallIsToldShortly) {
  for (const std::string program :
       {"generate_dataset", "model_tubes", "calibrate_modeler", "export_dataset", "evaluate", "view"})
    for (const char* argument : {"", "--nonsense"}) {
      std::vector<std::string> call = {program_path(program)};
      if (*argument != 0) call.emplace_back(argument);
      const ProgramResult result = Program(call).wait();
      EXPECT_EQ(result.exit_code, 2);
      EXPECT_THAT(result.error, HasSubstr(argument));
      EXPECT_EQ(std::count(result.error.begin(), result.error.end(), '\n'), 3) << result.error;
      EXPECT_THAT(result.error, AllOf(::testing::StartsWith(program + ": "), HasSubstr("\nUsage: " + program + " "),
                                      HasSubstr("\nSee " + program + " --help.\n")));
    }
  EXPECT_THAT(Program({program_path("export_dataset")}).wait().error, HasSubstr("DATASET --format "));
  EXPECT_THAT(Program({program_path("view"), "a", "b", "c"}).wait().error,
              ::testing::StartsWith("view: not expected: b c\n"));
  EXPECT_THAT(Program({program_path("calibrate_modeler"), "data", "--outptu", "x"}).wait().error,
              ::testing::StartsWith("calibrate_modeler: not expected: --outptu x\n"));
}

}  // namespace
}  // namespace tubebin::testing
