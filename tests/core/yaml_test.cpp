#include "tubebin/core/yaml.hpp"

#include <gmock/gmock.h>

namespace tubebin {
namespace {

using ::testing::HasSubstr;

struct Options {
  double radius = 0.5;
  int count = 3;
  bool on = false;
  std::uint64_t seed = 7;
  std::string name = "a \"b\"";
  Vec3 place = {1.0, 2.0, 0.1};
  std::vector<int> list = {1, 2};
  int kind = 1;
};

void describe(Fields& fields, Options& o) {
  fields.group("tube", "the tube", [&](Fields& tube) {
    tube.number("radius", o.radius, {0.1, 1.0}, "m", "how thick");
    tube.integer("count", o.count, {1, 10}, "", "how many");
    tube.removed("weight", "changed nothing");
  });
  fields.flag("on", o.on, "whether");
  fields.seed("seed", o.seed, "randomness");
  fields.text("name", o.name, "called");
  fields.vector("place", o.place, {}, "m", "where");
  fields.integers("list", o.list, {0, 99}, "which");
  fields.choice("kind", o.kind, {"red", "green"}, "of what kind");
}

Options read(const std::string& text) {
  Options options;
  read_yaml_text(text, "test.yaml", [&](Fields& f) { describe(f, options); });
  return options;
}

std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Yaml, ReadsEveryTypeAndKeepsDefaults) {
  const Options o = read("tube: {radius: 0.25}\non: true\nseed: 18446744073709551615\nplace: [0, 1, 2]\nkind: red");
  EXPECT_EQ(o.radius, 0.25);
  EXPECT_EQ(o.count, 3);
  EXPECT_TRUE(o.on);
  EXPECT_EQ(o.seed, UINT64_MAX);
  EXPECT_EQ(o.place, Vec3(0, 1, 2));
  EXPECT_EQ(o.kind, 0);
}

TEST(Yaml, WritesWhatReadsBackTheSame) {
  Options o;
  o.radius = 0.1 + 0.2;
  o.list = {5, 6, 7};
  o.name = "two\nlines\t\"and\\\x7F: #";
  const Options back = read(write_yaml([&](Fields& f) { describe(f, o); }));
  EXPECT_EQ(back.radius, o.radius);
  EXPECT_EQ(back.name, o.name);
  EXPECT_EQ(back.list, o.list);
  EXPECT_EQ(back.place, o.place);
}

TEST(Yaml, ErrorsNamePlaceKeyValueAndWhatIsValid) {
  EXPECT_EQ(error_of("tube:\n  radius: 3"), "test.yaml:2:11: tube.radius: '3' is not valid; valid: 0.1 to 1 m");
  EXPECT_THAT(error_of("tube: {radius: .nan}"), HasSubstr("test.yaml:1:16: tube.radius: '.nan' is not valid"));
  EXPECT_THAT(error_of("tube: {radius: thick}"), HasSubstr("'thick' is not valid; valid: 0.1 to 1 m"));
  EXPECT_THAT(error_of("tube: {radius: }"), HasSubstr("'nothing' is not valid"));
  EXPECT_THAT(error_of("tube: {count: 2.5}"), HasSubstr("'2.5' is not valid; valid: a whole number, 1 to 10"));
  EXPECT_THAT(error_of("seed: -1"), HasSubstr("'-1' is not valid"));
  EXPECT_THAT(error_of("place: [1, 2]"), HasSubstr("a list of three numbers"));
  EXPECT_THAT(error_of("kind: blue"), HasSubstr("valid: one of red, green"));
  EXPECT_THAT(error_of("tube: 5"), HasSubstr("tube: '5' is not valid; valid: a mapping"));
}

TEST(Yaml, SuggestsTheKeyThatWasMeant) {
  EXPECT_THAT(error_of("tube:\n  radios: 0.2"), HasSubstr("test.yaml:2:3: tube.radios: unknown key, did you mean "
                                                          "'radius'?; valid here: count, radius"));
  EXPECT_THAT(error_of("zzzzzzzz: 1"), ::testing::Not(HasSubstr("did you mean")));
}

TEST(Yaml, SaysWhyAKeyWentAndShowsItToNobodyElse) {
  EXPECT_EQ(error_of("tube:\n  weight: 2"),
            "test.yaml:2:11: tube.weight: is no key any more, since it changed nothing; remove it");
  EXPECT_THAT(error_of("tube: {wait: 2}"), HasSubstr("valid here: count, radius"));
  Options o;
  EXPECT_THAT(write_yaml([&](Fields& f) { describe(f, o); }), ::testing::Not(HasSubstr("weight")));
}

TEST(Yaml, RefusesDuplicateKeysAndWhatIsNoMapping) {
  EXPECT_THAT(error_of("on: true\non: false"), HasSubstr("test.yaml:2:1: on: the key stands here a second time"));
  EXPECT_THAT(error_of(""), HasSubstr("the file is empty"));
  EXPECT_THAT(error_of("[1, 2]"), HasSubstr("expected a mapping"));
  EXPECT_THAT(error_of("a: [1"), HasSubstr("not valid YAML"));
}

TEST(Yaml, RefusesASecondDocument) {
  EXPECT_THAT(error_of("on: true\n---\non: false"), HasSubstr("another YAML document starts here"));
  EXPECT_THAT(error_of(","), HasSubstr("the file is empty"));  // yaml-cpp finds documents without end in it
}

}  // namespace
}  // namespace tubebin
