#include "core/json_reader.hpp"

#include <gmock/gmock.h>

namespace tubebin {
namespace {

using ::testing::HasSubstr;

std::string nested(std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); }

TEST(JsonReader, TakesOneHundredLevelsAndNoMore) {
  EXPECT_NO_THROW(parse_json(nested(100), "x.json"));
  EXPECT_NO_THROW(parse_ordered_json(nested(100), "x.json"));
  for (const std::size_t depth : {101U, 65'000U, 1'000'000U})
    for (const std::string& text : {nested(depth), std::string(depth, '['), "{\"a\":" + nested(depth) + "}"}) {
      EXPECT_THROW(parse_json(text, "x.json"), IoError);
      EXPECT_THROW(parse_ordered_json(text, "x.json"), IoError);
    }
  EXPECT_NO_THROW(parse_json("[\"" + std::string(1000, '[') + "\\\"[[\"]", "x.json")) << "brackets in a text";
}

TEST(JsonReader, RefusesWhatIsTooLong) {
  EXPECT_THROW(parse_json(std::string(kJsonBytesMax + 1, ' '), "x.json"), IoError);
}

}  // namespace
}  // namespace tubebin
