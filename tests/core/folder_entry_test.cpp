// Whatever links lie in an output folder, nothing outside is written, replaced or removed.
#include "tubebin/core/folder_entry.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>

#include "support/program.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::testing {
namespace {

using ::testing::HasSubstr;

class FolderEntryTest : public ::testing::Test {
 protected:
  FolderEntryTest() {
    fs::create_directories(outside_ + "/inner");
    write_text(outside_ + "/inner/photo", "photo");
    write_text(outside_ + "/file", "file");
  }

  void expect_outside_untouched() const {
    EXPECT_EQ(read_text(outside_ + "/file"), "file");
    EXPECT_EQ(read_text(outside_ + "/inner/photo"), "photo");
    EXPECT_EQ(std::distance(fs::recursive_directory_iterator(outside_), fs::recursive_directory_iterator()), 3);
  }

  TemporaryFolder folder_;
  std::string outside_ = folder_ / "outside";
  OutputFolder output_{folder_ / "output"};
};

TEST_F(FolderEntryTest, MakesFoldersOnTheWay) {
  write_atomically(output_.make_entry("A10/007/cloud.pcd"), "bytes");
  EXPECT_EQ(read_text(output_.place("A10/007/cloud.pcd")), "bytes");
  EXPECT_TRUE(output_.has_file("A10/007/cloud.pcd"));
  EXPECT_TRUE(output_.has_folder("A10/007"));
  EXPECT_FALSE(output_.has_folder("A10/008"));
}

TEST_F(FolderEntryTest, NoLinkOnTheWayIsFollowed) {
  fs::create_directory_symlink(outside_, output_.place("A10"));
  try {
    write_atomically(output_.make_entry("A10/inner/photo"), "x");
    FAIL();
  } catch (const IoError& error) {
    EXPECT_THAT(error.what(), HasSubstr("output/A10: cannot be written: is a link"));
  }
  EXPECT_FALSE(output_.has_file("A10/file"));
  EXPECT_FALSE(output_.has_folder("A10"));
  EXPECT_LT(output_.open("A10").get(), 0);
  expect_outside_untouched();
}

TEST_F(FolderEntryTest, ALinkAtTheEndIsReplacedOrRefused) {
  fs::create_symlink(outside_ + "/file", output_.place("a"));
  EXPECT_THROW(open_file(output_.make_entry("a"), O_RDWR | O_CREAT), IoError);
  EXPECT_FALSE(create_atomically(output_.make_entry("a"), "new"));
  write_atomically(output_.make_entry("a"), "new");
  EXPECT_EQ(read_text(output_.place("a")), "new");
  expect_outside_untouched();
}

TEST_F(FolderEntryTest, RemovingTakesLinksAndNotWhatTheyLeadTo) {
  fs::create_directories(output_.place("A10/007/deep"));
  fs::create_directory_symlink(outside_, output_.place("A10/007/deep/link"));
  fs::create_symlink(outside_ + "/file", output_.place("A10/007/file"));
  remove_entry(output_.make_entry("A10/007"));
  EXPECT_FALSE(fs::exists(output_.place("A10/007")));
  fs::create_directory_symlink(outside_ + "/inner", output_.place("set"));
  remove_entry(output_.make_entry("set"));
  EXPECT_FALSE(fs::is_symlink(output_.place("set")));
  remove_entry(output_.make_entry("nothing"));
  expect_outside_untouched();
}

TEST_F(FolderEntryTest, AFileOfOtherNamesIsCopiedBeforeItIsWritten) {
  fs::create_hard_link(outside_ + "/file", output_.place("pack"));
  const FileDescriptor file = open_file(output_.make_entry("pack"), O_RDWR);
  ASSERT_EQ(pwrite(file.get(), "X", 1, 0), 1);
  EXPECT_EQ(read_text(output_.place("pack")), "Xile");
  expect_outside_untouched();
}

TEST_F(FolderEntryTest, WhatIsNoFileIsRefusedAtOnce) {
  ASSERT_EQ(mkfifo(output_.place("pipe").c_str(), 0600), 0);
  EXPECT_THROW(open_file(output_.make_entry("pipe"), O_RDWR), IoError);
  EXPECT_THROW(open_file(output_.make_entry("pipe"), O_RDONLY), IoError);
  EXPECT_THROW(write_atomically(output_.make_entry("pipe"), "x"), IoError);
}

TEST_F(FolderEntryTest, AFolderThatWasRemovedIsNotMadeAgain) {
  fs::remove_all(output_.path());
  EXPECT_THROW(write_atomically(output_.make_entry("a"), "x"), IoError);
  EXPECT_THROW(output_.make_entry("A10/007"), IoError);
  EXPECT_FALSE(fs::exists(output_.path()));
}

TEST_F(FolderEntryTest, WhatADeadProcessLeftOfAFileGoesWithTheNextOne) {
  const std::string report = folder_ / "report.html";
  const pid_t dead = fork();
  if (dead == 0) {
    write_text(folder_ / unfinished_name("report.html"), "half");
    _exit(0);
  }
  ASSERT_EQ(waitpid(dead, nullptr, 0), dead);
  const std::string own = folder_ / unfinished_name("report.html");
  write_text(own, "of this process, which lives");
  write_file_atomically(report, "whole");
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(fs::path(report).parent_path()))
    if (is_unfinished_name(entry.path().filename().string())) left.push_back(entry.path().string());
  EXPECT_THAT(left, ::testing::ElementsAre(own));
}

}  // namespace
}  // namespace tubebin::testing
