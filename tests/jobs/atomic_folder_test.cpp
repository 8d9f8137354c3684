#include "tubebin/jobs/atomic_folder.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <thread>

#include "support/program.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::testing {

using namespace jobs;
namespace {

namespace fs = std::filesystem;

// As where a job is given to two machines: the one that starts later clears what the first is writing.
TEST(WholeFolder, IsWholeOrNotThereWhileAnotherClears) {
  const TemporaryFolder folder;
  const std::string data = folder / "Q1", scene = data + "/001";
  fs::create_directory(data);
  const OutputFolder output(folder / "");
  std::map<std::string, std::string> files;
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h"}) files[name] = "bytes";

  std::atomic<bool> done = false;
  std::atomic<int> failed_clearings = 0;
  std::thread clearer([&] {
    while (!done) try {
        remove_unfinished(output, "Q1");
      } catch (const IoError&) {
        ++failed_clearings;
      }
  });
  int written = 0;
  for (int round = 0; round < 500; ++round) {
    try {
      begin_whole_folder(output, "Q1/001", files)();
    } catch (const IoError&) {
      continue;
    }
    ++written;
    for (const auto& [name, bytes] : files) EXPECT_TRUE(fs::exists(scene + "/" + name)) << name << " of " << round;
  }
  done = true;
  clearer.join();
  EXPECT_EQ(failed_clearings, 0);
  remove_unfinished(output, "Q1");
  EXPECT_EQ(std::distance(fs::directory_iterator(data), fs::directory_iterator()), written > 0 ? 1 : 0);
}

// As where one part of a data set has packed all its scenes while another still makes some.
TEST(WholeFolder, AppearsThoughAnotherRemovesTheEmptyFolderAroundIt) {
  const TemporaryFolder folder;
  const OutputFolder output(folder / "");
  std::atomic<bool> done = false;
  std::atomic<int> removed = 0;
  std::thread remover([&] {
    while (!done) removed += ::rmdir((folder / "Q1").c_str()) == 0 ? 1 : 0;
  });
  for (int round = 0; round < 200; ++round) {
    EXPECT_NO_THROW(begin_whole_folder(output, "Q1/001", {{"a", "bytes"}})()) << round;
    EXPECT_EQ(read_text(folder / "Q1/001/a"), "bytes") << round;
    fs::remove_all(folder / "Q1/001");
  }
  done = true;
  remover.join();
  EXPECT_GT(removed, 0);
}

// As an export of hundreds of tubes, each of which has its masks.
TEST(WholeFolder, OfManyFilesNeedsFewOpenFiles) {
  const TemporaryFolder folder;
  std::map<std::string, std::string> files;
  for (int i = 0; i < 1000; ++i) files[fmt::format("mask/{}", i)] = std::to_string(i);
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit usual = {1024, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &usual), 0);
  EXPECT_NO_THROW(begin_whole_folder(OutputFolder(folder / ""), "001", files)());
  setrlimit(RLIMIT_NOFILE, &before);
  for (const auto& [name, bytes] : files) EXPECT_EQ(read_text(folder / ("001/" + name)), bytes) << name;
}

}  // namespace
}  // namespace tubebin::testing
