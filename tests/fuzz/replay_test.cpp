/// Every input that a fuzzer started from or that once broke a reader: none may break one again.
#include <gtest/gtest.h>

#include <filesystem>

#include "fuzz/targets.hpp"
#include "tubebin/core/atomic_file.hpp"

namespace tubebin {
namespace {

void replay(const char* target, void (*function)(std::string_view)) {
  int inputs = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(TUBEBIN_SOURCE_DIR "/tests/fuzz/corpus/" + std::string(target))) {
    SCOPED_TRACE(entry.path());
    const std::string bytes = read_file(entry.path().string());
    EXPECT_NO_THROW(function(bytes));
    ++inputs;
  }
  EXPECT_GT(inputs, 0);
}

TEST(FuzzReplay, Cloud) { replay("cloud", fuzz::cloud); }
TEST(FuzzReplay, TubesTxt) { replay("tubes_txt", fuzz::tubes_txt); }
TEST(FuzzReplay, SceneJson) { replay("scene_json", fuzz::scene_json); }
TEST(FuzzReplay, ResultIndex) { replay("result_index", fuzz::result_index); }
TEST(FuzzReplay, Run) { replay("run", fuzz::run); }
TEST(FuzzReplay, Times) { replay("times", fuzz::times); }
TEST(FuzzReplay, Failures) { replay("failures", fuzz::failures); }
TEST(FuzzReplay, Yaml) { replay("yaml", fuzz::yaml); }

}  // namespace
}  // namespace tubebin
