// Paths that lead nowhere a program may look: each is named, with what is wrong about it, in the project's own words.
#include <gmock/gmock.h>
#include <unistd.h>

#include "support/program.hpp"

namespace tubebin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class UnreachablePaths : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    write_text(*folder_ / "config.yaml", "set: U\ntubes: [1]\ncases: 2\nscanner: {width: 160, height: 100}\n");
    ASSERT_EQ(run_generate_dataset({*folder_ / "config.yaml", "--output", *folder_ / "data", "--quiet"}).exit_code, 0);
    fs::copy(*folder_ / "data", *folder_ / "locked", fs::copy_options::recursive);
    fs::permissions(*folder_ / "locked", fs::perms::none);
    fs::permissions(*folder_ / "", fs::perms::all);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  /// Every way to name a path that is read or written, with `path` in its place.
  static std::vector<std::vector<std::string>> calls_on(const std::string& path) {
    const std::string data = *folder_ / "data", config = *folder_ / "config.yaml", output = *folder_ / "never";
    return {{"generate_dataset", path, "--output", output},
            {"generate_dataset", config, "--output", path + "/data"},
            {"generate_dataset", "--verify", path},
            {"generate_dataset", "--merge", output, path},
            {"model_tubes", path, "--output", output},
            {"model_tubes", path + "/cloud.pcd", "--output", output},
            {"model_tubes", data, "--output", path + "/results"},
            {"model_tubes", "--resume", path},
            {"evaluate", path},
            {"evaluate", path, "--predictions", data},
            {"evaluate", data, "--predictions", path},
            {"evaluate", "--filtered", path + "/a.pcd", "--labeled", path + "/b.pcd"},
            {"export_dataset", path, "--format", "npz", "--output", output},
            {"export_dataset", data, "--format", "npz", "--output", path + "/export"},
            {"view", path, "--html", output},
            {"view", data + "/U1/001", "--html", path + "/view.html"},
            {"calibrate_modeler", path, "--output", output},
            {"calibrate_modeler", data, "--output", path + "/tuned.yaml"}};
  }

  static void expect_named(const std::string& path, const std::string& cause,
                           const std::vector<std::string>& prefix = {}) {
    for (std::vector<std::string> call : calls_on(path)) {
      call.front() = program_path(call.front());
      call.insert(call.begin(), prefix.begin(), prefix.end());
      const ProgramResult result = Program(call).wait();
      EXPECT_TRUE(result.exit_code == 1 || result.exit_code == 2) << result.exit_code << ::testing::PrintToString(call);
      EXPECT_THAT(result.error, AllOf(HasSubstr(path), HasSubstr(cause), Not(HasSubstr("filesystem error"))))
          << ::testing::PrintToString(call);
    }
  }

  static std::unique_ptr<TemporaryFolder> folder_;
};
std::unique_ptr<TemporaryFolder> UnreachablePaths::folder_;

TEST_F(UnreachablePaths, ANameThatIsTooLong) { expect_named(*folder_ / std::string(300, 'n'), "File name too long"); }

TEST_F(UnreachablePaths, AFolderThatMayNotBeRead) {
  // Root may read all.
  const std::vector<std::string> as_nobody = {"/usr/bin/setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"};
  expect_named(*folder_ / "locked", "Permission denied", geteuid() == 0 ? as_nobody : std::vector<std::string>{});
}

TEST_F(UnreachablePaths, SaysHowLongANameMayBe) {
  const ProgramResult result = run_generate_dataset({"--verify", *folder_ / std::string(300, 'n')});
  EXPECT_THAT(result.error, HasSubstr("valid: names of up to 255 bytes, paths of up to 4095"));
}

}  // namespace
}  // namespace tubebin::testing
