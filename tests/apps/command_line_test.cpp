// Numbers on the command line that are none: the message names the option, the word, and what would be right.
#include <gmock/gmock.h>

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

}  // namespace
}  // namespace tubebin::testing
