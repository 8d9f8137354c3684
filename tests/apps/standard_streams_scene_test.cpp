// What the programs do where their standard streams are closed, or where nothing can be written to them.
#include <gmock/gmock.h>

#include <cstdlib>

#include "support/program.hpp"

namespace tubebin::testing {
namespace {

using ::testing::HasSubstr;

class StandardStreams : public ::testing::Test {
 protected:
  StandardStreams() {
    write_text(folder_ / "c.yaml",
               "set: L\ntubes: [1]\ncases: 2\ntube: {length: 0.2}\nscanner: {width: 160, height: 100}\n");
  }

  /// The exit code of a shell's command; 128 and more: ended by a signal.
  int shell(const std::string& command) const {
    return run({"/bin/bash", "-c", "cd " + (folder_ / "") + "; " + command}).exit_code;
  }
  static ProgramResult run(const std::vector<std::string>& arguments) { return Program(arguments).wait(); }

  TemporaryFolder folder_;
  std::string generate_ = program_path("generate_dataset") + " c.yaml --output data";
};

TEST_F(StandardStreams, MessagesThatNobodyTakesEndNothing) {
  for (const char* nowhere : {"2>/dev/full", "2>&-"}) {
    SCOPED_TRACE(nowhere);
    EXPECT_EQ(shell("rm -rf data results x; " + generate_ + " " + nowhere), 0);
    EXPECT_EQ(shell(program_path("generate_dataset") + " --verify data " + nowhere), 0);
    EXPECT_EQ(shell(program_path("model_tubes") + " data --output results " + nowhere), 0);
    EXPECT_EQ(shell(program_path("evaluate") + " results " + nowhere), 0);
    EXPECT_EQ(shell(program_path("export_dataset") + " data --format npz --output x " + nowhere), 0);
    EXPECT_EQ(shell(program_path("generate_dataset") + " nothing.yaml --output y " + nowhere), 2);
  }
}

TEST_F(StandardStreams, NoFileTakesThePlaceOfAClosedStream) {
  ASSERT_EQ(shell(generate_ + " --shard 1/1 <&- 2>&- >&-") & ~1, 0);
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_ / "data"))
    if (entry.is_regular_file()) {
      EXPECT_EQ(read_text(entry.path()).find("scenes/s"), std::string::npos) << entry.path();
    }
  EXPECT_EQ(shell(program_path("generate_dataset") + " --verify data"), 0);
}

TEST_F(StandardStreams, ResultsThatCannotBeWrittenAreAnError) {
  ASSERT_EQ(shell(generate_ + " -q"), 0);
  ASSERT_EQ(shell(program_path("model_tubes") + " data --output results -q"), 0);
  for (const char* format : {"table", "csv", "json", "markdown"})
    for (const char* nowhere : {">/dev/full", ">&-"})
      EXPECT_EQ(shell(program_path("evaluate") + " results --format " + format + " " + nowhere), 1)
          << format << nowhere;
  EXPECT_EQ(shell(program_path("generate_dataset") + " --config-reference > /dev/full"), 1);
  EXPECT_EQ(shell(program_path("evaluate") + " --help > /dev/full"), 1);
  const ProgramResult result =
      run({"/bin/bash", "-c", program_path("evaluate") + " " + (folder_ / "results") + " > /dev/full"});
  EXPECT_THAT(result.error, HasSubstr("standard output: cannot be written"));
}

TEST_F(StandardStreams, AFileSizeLimitIsAnErrorThatNamesTheFile) {
  const ProgramResult result =
      run({"/bin/bash", "-c", "ulimit -f 12; cd " + (folder_ / "") + "; exec " + generate_ + " -q"});
  EXPECT_EQ(result.exit_code, 1) << result.signal;
  EXPECT_THAT(result.error, HasSubstr("cloud.pcd: cannot be written: File too large"));
  EXPECT_EQ(shell(generate_ + " -q"), 0);
}

TEST_F(StandardStreams, NumbersAreDecimalEverywhere) {
  write_text(folder_ / "o.yaml", "set: W\ntubes: [010]\ncases: 01\nscanner: {width: 32, height: 20}\n");
  ASSERT_EQ(shell(program_path("generate_dataset") + " o.yaml --output a -q"), 0);
  EXPECT_TRUE(fs::exists(folder_ / "a/W10/001"));
  ASSERT_EQ(shell(program_path("generate_dataset") + " o.yaml --output b --tubes 1 --cases 010 --seed 010 -q"), 0);
  EXPECT_TRUE(fs::exists(folder_ / "b/W1/010"));
  EXPECT_FALSE(fs::exists(folder_ / "b/W1/011"));
  EXPECT_THAT(read_text(folder_ / "b/config.yaml"), HasSubstr("\nseed: 10 "));
}

TEST_F(StandardStreams, CommandsThatAreShownWorkForAFolderWithADash) {
  ASSERT_EQ(shell(program_path("generate_dataset") + " c.yaml --output=-dash -q; rm -r ./-dash/L1/001"), 0);
  const ProgramResult result =
      run({"/bin/bash", "-c", "cd " + (folder_ / "") + "; " + program_path("generate_dataset") + " --merge=-dash"});
  EXPECT_EQ(result.exit_code, 3);
  const std::size_t command = result.out.find("\n  generate_dataset");
  ASSERT_NE(command, std::string::npos) << result.out;
  const std::string shown = result.out.substr(command + 3, result.out.find('\n', command + 3) - command - 3);
  EXPECT_EQ(shell("PATH=" TUBEBIN_BIN_DIR ":$PATH; " + shown), 0) << shown;
}

TEST_F(StandardStreams, APathThatIsNoTextIsNamed) {
  ASSERT_EQ(shell(generate_ + " -q; mv data $'d\\xff'"), 0);
  const ProgramResult result = run(
      {"/bin/bash", "-c", "cd " + (folder_ / "") + "; " + program_path("model_tubes") + " $'d\\xff' --output r -q"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.error, HasSubstr("no UTF-8"));
}

}  // namespace
}  // namespace tubebin::testing
