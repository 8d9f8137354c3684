#include "tubebin/core/confined_path.hpp"

#include <gmock/gmock.h>

#include "tubebin/core/error.hpp"

namespace tubebin {
namespace {

using ::testing::HasSubstr;

TEST(ConfinedPath, HoldsNamesBeneathAFolder) {
  for (const char* good : {"A10/007", "A1/12000/12345", "cloud.pcd", "a b", "-dash", "Röhre/1", "..a", "."}) {
    if (std::string(good) == "..a") EXPECT_THROW(ConfinedPath path(good), IoError) << "hidden";
    else EXPECT_EQ(ConfinedPath(good).str(), good);
  }
}

TEST(ConfinedPath, HoldsNothingElse) {
  const std::string too_long(151, 'x');
  std::string very_deep = "d";
  for (int i = 0; i < 600; ++i) very_deep += "/d";
  for (const std::string& bad : {std::string(""),
                                 std::string("/etc/passwd"),
                                 std::string(".."),
                                 std::string("../x"),
                                 std::string("a/../../x"),
                                 std::string("a/.."),
                                 std::string("a//b"),
                                 std::string("a/"),
                                 std::string("/"),
                                 std::string("./a"),
                                 std::string("a/./b"),
                                 std::string(".lock"),
                                 std::string("A1/.007.partial"),
                                 std::string("a\nb"),
                                 std::string("a\x1b[2J"),
                                 std::string("a\0b", 3),
                                 std::string("\xff\xfe"),
                                 std::string("\xc0\xae\xc0\xae/x"),
                                 std::string("\xed\xa0\x80"),
                                 too_long,
                                 very_deep})
    EXPECT_THROW(ConfinedPath path(bad), IoError) << bad;
}

TEST(ConfinedPath, ErrorsNameThePlaceAndTheText) {
  try {
    ConfinedPath::parse("../x", "DIR/manifest.jsonl:3");
    FAIL();
  } catch (const IoError& error) {
    EXPECT_THAT(error.what(), HasSubstr("DIR/manifest.jsonl:3: '../x' leads out of its folder"));
  }
  EXPECT_THROW(ConfinedPath::parse_name("a/b", ""), IoError);
  EXPECT_THROW(ConfinedPath::parse_name(".", ""), IoError);
  EXPECT_EQ(ConfinedPath::parse_name("a", "").str(), "a");
}

TEST(ConfinedPath, JoinsAndParts) {
  const ConfinedPath scene = ConfinedPath("A10") / "007";
  EXPECT_EQ(scene.str(), "A10/007");
  EXPECT_EQ(scene.parent().str(), "A10");
  EXPECT_EQ(scene.name(), "007");
  EXPECT_TRUE(ConfinedPath("A10").parent().is_folder_itself());
  EXPECT_EQ((ConfinedPath() / scene).str(), "A10/007");
  EXPECT_EQ((scene / ConfinedPath()).str(), "A10/007");
}

}  // namespace
}  // namespace tubebin
