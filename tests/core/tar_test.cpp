// Tar files of our own and of GNU tar, whole, growing and broken.
#include "tubebin/core/tar.hpp"

#include <gmock/gmock.h>

#include <cstdlib>

#include "support/program.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::testing {
namespace {

class Tar : public ::testing::Test {
 protected:
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const TarMember& member : list_tar(path_)) names.push_back(member.name);
    return names;
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "a.tar";
};

TEST_F(Tar, GivesBackWhatWasPutIn) {
  const std::string odd(513, 'x');
  write_text(path_, format_tar_member("A1/001.cloud.pcd", odd) + format_tar_member("A1/001.empty", "") +
                        format_tar_member("A1/12000/12345.scene.json", "{}") + format_tar_end());
  EXPECT_THAT(names(), ::testing::ElementsAre("A1/001.cloud.pcd", "A1/001.empty", "A1/12000/12345.scene.json"));
  const std::vector<TarMember> members = list_tar(path_);
  EXPECT_EQ(read_tar_member(path_, members[0]), odd);
  EXPECT_EQ(read_tar_member(path_, members[1]), "");
  EXPECT_EQ(read_tar_member(path_, members[2]), "{}");
  EXPECT_EQ(format_tar_member("a", "b"), format_tar_member("a", "b"));
  EXPECT_EQ(format_tar_member("a", odd).size() % 512, 0u);
}

TEST_F(Tar, ReadsThoseOfOtherPrograms) {
  // Names too long for one header have headers of their own before them.
  const std::string longest = std::string(120, 'd') + "/" + std::string(120, 'f') + ".txt";
  fs::create_directories(folder_ / ("in/" + std::string(120, 'd')));
  write_text(folder_ / ("in/" + longest), "long");
  write_text(folder_ / "in/short.txt", "short");
  for (const std::string format : {"gnu", "pax", "ustar"}) {
    if (format == "ustar") fs::remove_all(folder_ / ("in/" + std::string(120, 'd')));
    const ProgramResult made =
        Program({"/bin/tar", "--format=" + format, "-C", folder_ / "in", "-cf", path_, "."}).wait();
    ASSERT_EQ(made.exit_code, 0) << made.error;
    const std::vector<TarMember> members = list_tar(path_);
    EXPECT_EQ(members.size(), format == "ustar" ? 1u : 2u);
    for (const TarMember& member : members)
      EXPECT_EQ(read_tar_member(path_, member), member.name == "./short.txt" ? "short" : "long") << format;
  }
}

TEST_F(Tar, OneThatIsCutShortHasItsWholeMembers) {
  const std::string first = format_tar_member("first", std::string(1000, '1'));
  const std::string whole = first + format_tar_member("second", std::string(1000, '2')) + format_tar_end();
  for (std::size_t bytes = first.size(); bytes < whole.size(); bytes += 100) {
    write_text(path_, whole.substr(0, bytes));
    const bool has_second = bytes >= first.size() + 512 + 1000;
    EXPECT_EQ(names().size(), has_second ? 2u : 1u) << bytes;
  }
  write_text(path_, "");
  EXPECT_TRUE(names().empty());
}

TEST_F(Tar, WhatIsNoneIsRefused) {
  write_text(path_, std::string(5000, 'x'));
  EXPECT_THROW(list_tar(path_), IoError);
  EXPECT_THROW(list_tar(folder_ / "nowhere.tar"), IoError);
  EXPECT_THROW(read_tar_member(path_, {"a", 4000, 2000}), IoError);
}

}  // namespace
}  // namespace tubebin::testing
