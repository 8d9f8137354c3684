#include "tubebin/core/atomic_file.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "tubebin/core/error.hpp"

namespace tubebin {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class AtomicFile : public ::testing::Test {
 protected:
  AtomicFile() { fs::remove_all(folder_), fs::create_directories(folder_); }
  ~AtomicFile() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::ptrdiff_t entries() const { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); }

  const fs::path folder_ =
      fs::path(::testing::TempDir()) / ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const IoError& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(AtomicFile, ReadsBackEveryByteAndLeavesNothingElse) {
  std::string bytes;
  for (int i = 0; i < 100000; ++i) bytes.push_back(static_cast<char>(i));
  write_file_atomically(path("a"), bytes);
  EXPECT_EQ(read_file(path("a")), bytes);
  write_file_atomically(path("a"), "");
  EXPECT_EQ(read_file(path("a")), "");
  EXPECT_EQ(entries(), 1);
}

TEST_F(AtomicFile, AFullDiskLeavesTheOldFileAndNoTemporary) {
  write_file_atomically(path("a"), "old");
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small = {1000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string error = error_of([&] { write_file_atomically(path("a"), std::string(5000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);

  EXPECT_EQ(error, path("a") + ": cannot be written: File too large");
  EXPECT_EQ(read_file(path("a")), "old");
  EXPECT_EQ(entries(), 1);
}

TEST_F(AtomicFile, ManyAtOnceNeedFewOpenFiles) {
  std::map<std::string, std::string> files;
  for (int i = 0; i < 1000; ++i) files[fmt::format("{}/{}", i % 2, i)] = std::to_string(i);
  files["0/7"] = "new";
  fs::create_directories(path("0"));
  write_file_atomically(path("0/7"), "old");
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit usual = {1024, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &usual), 0);
  const std::string error = error_of([&] { write_all_atomically(OutputFolder(path("")), files); });
  setrlimit(RLIMIT_NOFILE, &before);

  EXPECT_EQ(error, "no error");
  for (const auto& [name, bytes] : files) EXPECT_EQ(read_file(path(name)), bytes) << name;
  EXPECT_EQ(std::distance(fs::recursive_directory_iterator(folder_), fs::recursive_directory_iterator()), 1003);
}

TEST_F(AtomicFile, ErrorsNamePathAndCause) {
  EXPECT_EQ(error_of([&] { read_file(path("none")); }), path("none") + ": cannot be read: No such file or directory");
  EXPECT_EQ(error_of([&] { read_file(path("")); }), path("") + ": cannot be read: is a folder");
  EXPECT_EQ(error_of([&] { write_file_atomically(path("no/a"), "x"); }),
            path("no/a") + ": cannot be written: No such file or directory");
  EXPECT_THAT(error_of([&] { write_file_atomically(path(""), "x"); }), HasSubstr("no regular file"));
  EXPECT_THAT(error_of([&] { write_file_atomically("/dev/null", "x"); }), HasSubstr("no regular file"));
}

TEST_F(AtomicFile, ANamedPipeIsRefusedAtOnce) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_THAT(error_of([&] { read_file(path("pipe")); }), HasSubstr("is no regular file"));
  EXPECT_THAT(error_of([&] { read_file("/dev/zero"); }), HasSubstr("is no regular file"));
}

}  // namespace
}  // namespace tubebin
