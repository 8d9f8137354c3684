/// Files that lie, break off, or are no clouds at all.
#include <gmock/gmock.h>

#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/random.hpp"

namespace tubebin::cloud {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string error_of(const std::string& bytes) {
  try {
    parse_cloud(bytes, "a.pcd");
  } catch (const IoError& error) {
    return error.what();
  }
  return "no error";
}

struct Lines {
  std::string fields = "x y z";
  std::string size = "4 4 4";
  std::string type = "F F F";
  std::string count = "1 1 1";
  std::string width = "2";
  std::string height = "1";
  std::string viewpoint = "0 0 0 1 0 0 0";
  std::string points = "2";
  std::string data = "binary";
};

std::string pcd(const Lines& lines, const std::string& payload) {
  return "VERSION 0.7\nFIELDS " + lines.fields + "\nSIZE " + lines.size + "\nTYPE " + lines.type + "\nCOUNT " +
         lines.count + "\nWIDTH " + lines.width + "\nHEIGHT " + lines.height + "\nVIEWPOINT " + lines.viewpoint +
         "\nPOINTS " + lines.points + "\nDATA " + lines.data + "\n" + payload;
}

const std::string kTwoPoints(24, '\0');

TEST(HostilePcd, WhatIsNoCloudIsNamed) {
  EXPECT_EQ(error_of(""), "a.pcd: the file is empty; expected a PCD or PLY cloud");
  EXPECT_EQ(error_of("hello\x01 world"), "a.pcd: neither a PCD nor a PLY file: it starts with 'hello? world'");
  EXPECT_THAT(error_of("# .PCD v0.7"), HasSubstr("no DATA line"));
  EXPECT_THAT(error_of("VERSION 0.7\nFIELDS x y z\n"), HasSubstr("no DATA line"));
  EXPECT_THAT(error_of("VERSION 0.7\nWIDHT 3\n"), HasSubstr("a.pcd:2: 'WIDHT' is no entry of a PCD header"));
  EXPECT_EQ(error_of(pcd({}, kTwoPoints)), "no error");
}

TEST(HostilePcd, HeadersThatLieAreRefusedBeforeAnyAllocation) {
  EXPECT_EQ(error_of(pcd({}, kTwoPoints.substr(1))),
            "a.pcd: truncated: 2 points of 12 bytes are announced, but only 23 bytes are there");
  EXPECT_THAT(error_of(pcd({.width = "4000000000", .points = "4000000000"}, kTwoPoints)), HasSubstr("truncated"));
  EXPECT_THAT(error_of(pcd({.width = "4294967295", .height = "4294967295", .points = "1"}, kTwoPoints)),
              HasSubstr("says 1 points, but 4294967295 x 4294967295"));
  EXPECT_THAT(error_of(pcd({.width = "4294967296"}, kTwoPoints)), HasSubstr("a.pcd:6: WIDTH 4294967296 is not valid"));
  EXPECT_THAT(error_of(pcd({.width = "-2"}, kTwoPoints)), HasSubstr("WIDTH -2 is not valid"));
  EXPECT_THAT(error_of(pcd({.width = "two"}, kTwoPoints)), HasSubstr("WIDTH two is not valid"));
  EXPECT_THAT(error_of(pcd({.width = "3"}, kTwoPoints)), HasSubstr("says 2 points, but 3 x 1"));
  EXPECT_THAT(error_of(pcd({.width = "1", .points = "1", .data = "ascii"}, "1 2")), HasSubstr("truncated"));
  EXPECT_THAT(error_of(pcd({.width = "4294967295", .points = "4294967295", .data = "ascii"}, "1 2 3\n")),
              HasSubstr("truncated: 4294967295 points are announced, but only 6 bytes are there"));
}

TEST(HostilePcd, FieldsThatCannotBeAreNamed) {
  EXPECT_THAT(error_of(pcd({.fields = "x y w"}, kTwoPoints)), HasSubstr("missing here: z"));
  EXPECT_THAT(error_of(pcd({.fields = "x y x"}, kTwoPoints)), HasSubstr("the field x stands twice"));
  EXPECT_THAT(error_of(pcd({.size = "4 4"}, kTwoPoints)), HasSubstr("SIZE has 2 entries for 3 fields"));
  EXPECT_THAT(error_of(pcd({.size = "4 4 3"}, kTwoPoints)), HasSubstr("SIZE 3 is not valid; valid: 1, 2, 4 or 8"));
  EXPECT_THAT(error_of(pcd({.size = "4 4 2"}, kTwoPoints)), HasSubstr("a float of 2 bytes"));
  EXPECT_THAT(error_of(pcd({.type = "F F X"}, kTwoPoints)), HasSubstr("TYPE X is not valid"));
  EXPECT_THAT(error_of(pcd({.count = "1 1 2"}, kTwoPoints)), HasSubstr("the field z has 2 values a point"));
  EXPECT_THAT(error_of(pcd({.count = "1 1 4000000000"}, kTwoPoints)), HasSubstr("COUNT 4000000000 is not valid"));
  EXPECT_THAT(error_of(pcd({.viewpoint = "0 0 0 0 0 0 0"}, kTwoPoints)), HasSubstr("VIEWPOINT"));
  EXPECT_THAT(error_of(pcd({.viewpoint = "0 0 nan 1 0 0 0"}, kTwoPoints)), HasSubstr("VIEWPOINT"));
  EXPECT_THAT(error_of(pcd({.data = "zip"}, kTwoPoints)), HasSubstr("DATA zip is not valid"));
}

TEST(HostilePcd, TextThatIsNoNumberIsNamedByLine) {
  const Lines text = {.data = "ascii"};
  EXPECT_EQ(error_of(pcd(text, "1 2 3\n1 two 3\n")), "a.pcd:12: 'two' is not a number");
  EXPECT_EQ(error_of(pcd(text, "1 2 3\n1 2\n12 3\n")), "a.pcd:12: expected 3 values, found 2");
  EXPECT_EQ(error_of(pcd(text, "1 2 3 4\n1 2 3\n")), "a.pcd:11: expected 3 values, found more");
  EXPECT_EQ(error_of(pcd(text, "1 2 3\n\n      \n")), "a.pcd: truncated: 2 points are announced, but only 1 are there");
  EXPECT_EQ(error_of(pcd(text, "1 2 3\n1 2 3\n1 2 3\n")), "a.pcd:13: the header says 2 points, but there are more");
}

TEST(HostilePcd, LabelsAndColorsThatAreNoneAreNamed) {
  const Lines labelled = {"x y z label", "4 4 4 4", "F F F I", "1 1 1 1", "1", "1", "0 0 0 1 0 0 0", "1", "ascii"};
  EXPECT_THAT(error_of(pcd(labelled, "1 2 3 -1\n")), HasSubstr("point 0: label -1 is not valid"));
  EXPECT_THAT(error_of(pcd(labelled, "1 2 3 1.5\n")), HasSubstr("label 1.5 is not valid"));
  EXPECT_THAT(error_of(pcd(labelled, "1 2 3 4294967296\n")), HasSubstr("label 4294967296 is not valid"));
}

TEST(HostilePcd, CompressedSizesAreCheckedFirst) {
  const Lines lines = {.data = "binary_compressed"};
  const auto sizes = [](std::uint32_t packed, std::uint32_t unpacked) {
    return std::string(reinterpret_cast<const char*>(&packed), 4) +
           std::string(reinterpret_cast<const char*>(&unpacked), 4);
  };
  EXPECT_THAT(error_of(pcd(lines, "")), HasSubstr("truncated"));
  EXPECT_THAT(error_of(pcd(lines, sizes(10, 24) + "12345")),
              HasSubstr("10 compressed bytes are announced, but only 5"));
  EXPECT_THAT(error_of(pcd(lines, sizes(5, 4000000000) + "12345")), HasSubstr("cannot be the 4000000000 bytes"));
  EXPECT_THAT(error_of(pcd({.width = "300000000", .points = "300000000", .data = "binary_compressed"},
                           sizes(5, 3600000000) + "12345")),
              HasSubstr("5 compressed bytes cannot hold the 3600000000"));
  EXPECT_THAT(error_of(pcd(lines, sizes(5, 24) + "12345")), HasSubstr("damaged"));
}

TEST(HostilePly, HeadersThatLieAreRefused) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string head = "ply\nformat binary_little_endian 1.0\n";
  EXPECT_THAT(error_of("ply\n"), HasSubstr("no end_header"));
  EXPECT_THAT(error_of("ply\nend_header\n"), HasSubstr("no format line"));
  EXPECT_THAT(error_of("ply\nformat morse 1.0\n"), HasSubstr("a.pcd:2: format 'morse' is not valid"));
  EXPECT_THAT(error_of(head + "end_header\n"), HasSubstr("no vertex element"));
  EXPECT_THAT(error_of(head + "property float x\n"), HasSubstr("a property stands before any element"));
  EXPECT_THAT(error_of(head + "element vertex -1\n"), HasSubstr("with a count from 0"));
  EXPECT_THAT(error_of(head + "element vertex 1\nproperty float128 x\n"), HasSubstr("'float128' is no type"));
  EXPECT_THAT(error_of(head + "element vertex 1\nproperty float x\nend_header\n"), HasSubstr("missing here: y z"));
  EXPECT_THAT(error_of(head + "element vertex 4000000000\n" + xyz + "end_header\n123"), HasSubstr("truncated"));
  EXPECT_THAT(error_of(head + "element vertex 0\nelement vertex 1\n" + xyz + "end_header\n123"),
              HasSubstr("missing here: x y z"));
  EXPECT_THAT(error_of("ply\nformat ascii 1.0\nelement vertex 4000000000\n" + xyz + "end_header\n1 2 3\n"),
              HasSubstr("truncated"));
  EXPECT_THAT(error_of(head + "element face 9\nproperty list int int i\nelement vertex 0\n" + xyz +
                       "end_header\n\xFF\xFF\xFF\x7F"),
              HasSubstr("truncated"));
  EXPECT_THAT(error_of(head + "element vertex 1\n" + xyz + "property list uchar int i\nend_header\n"),
              HasSubstr("list properties"));
}

Cloud small_cloud() {
  Cloud cloud;
  cloud.width = 3;
  cloud.height = 2;
  for (int i = 0; i < 6; ++i) {
    cloud.points.emplace_back(0.1F * static_cast<float>(i), 1.0F, -2.0F);
    cloud.colors.push_back(0x112233);
    cloud.labels.push_back(static_cast<Label>(i));
  }
  return cloud;
}

/// Anything may come out of damaged bytes but a crash, and an error names the file.
void expect_cloud_or_error(const std::string& bytes) {
  try {
    const Cloud cloud = parse_cloud(bytes, "a.pcd");
    EXPECT_EQ(cloud.size(), std::size_t{cloud.width} * cloud.height);
  } catch (const IoError& error) {
    EXPECT_THAT(error.what(), StartsWith("a.pcd:"));
  }
}

TEST(HostileClouds, EveryPrefixAndRandomDamageIsSurvived) {
  Random random(3);
  for (const CloudFormat format :
       {CloudFormat::pcd_binary, CloudFormat::pcd_compressed, CloudFormat::pcd_ascii, CloudFormat::ply_binary}) {
    const std::string whole = format_cloud(small_cloud(), format);
    for (std::size_t size = 0; size < whole.size(); ++size) expect_cloud_or_error(whole.substr(0, size));
    for (int round = 0; round < 3000; ++round) {
      std::string damaged = whole;
      for (int hit = random.integer(1, 4); hit > 0; --hit)
        damaged[random.bits() % damaged.size()] = static_cast<char>(random.integer(0, 255));
      expect_cloud_or_error(damaged);
    }
  }
}

}  // namespace
}  // namespace tubebin::cloud
