#include "core/png.hpp"

#include <gmock/gmock.h>

#include <numeric>

#include "support/grey_png.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin {
namespace {

using ::testing::HasSubstr;

/// Every value that 16 bits have.
testing::GreyImage all_values() {
  testing::GreyImage image{512, 128, std::vector<std::uint16_t>(512 * 128)};
  std::iota(image.values.begin(), image.values.end(), std::uint16_t{0});
  return image;
}

TEST(Png, GreyIsReadByOthersAndReadFromOthersValueByValue) {
  const auto [width, height, values] = all_values();
  const testing::GreyImage read = testing::read_grey_png(encode_grey_png(values, width, height));
  EXPECT_EQ(read.width, width);
  EXPECT_EQ(read.height, height);
  EXPECT_EQ(read.values, values);
  EXPECT_EQ(decode_grey_png(testing::write_grey_png(all_values()), "image", width, height), values);
  EXPECT_EQ(decode_grey_png(encode_grey_png(values, width, height), "image", width, height), values);
}

std::string error_of(const std::string& bytes, int width, int height) {
  try {
    decode_grey_png(bytes, "a.png", width, height);
  } catch (const IoError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Png, RefusesWhatIsNoImageOfThatSizeAndKind) {
  const std::string sound = encode_grey_png({1, 2, 3, 4, 5, 6}, 3, 2);
  EXPECT_EQ(error_of(sound, 3, 2), "no error");
  EXPECT_EQ(error_of(sound, 2, 3), "a.png: 3 x 2 pixels; valid: 2 x 3 pixels with 16 bits of grey each");
  EXPECT_EQ(error_of(encode_rgb_png(std::vector<std::uint8_t>(18), 3, 2), 3, 2),
            "a.png: 3 x 2 pixels of another kind; valid: 3 x 2 pixels with 16 bits of grey each");
  EXPECT_THAT(error_of("", 3, 2), HasSubstr("a.png: is no PNG image"));
  EXPECT_THAT(error_of("GIF89a and so on", 3, 2), HasSubstr("a.png: is no PNG image"));
  for (std::size_t size = 0; size + 12 < sound.size(); ++size)  // the last 12 bytes, IEND, say nothing
    EXPECT_THAT(error_of(sound.substr(0, size), 3, 2), HasSubstr("a.png: is ")) << size;
  std::string flipped = sound;
  flipped[sound.size() - 20] = static_cast<char>(flipped[sound.size() - 20] ^ 1);
  EXPECT_THAT(error_of(flipped, 3, 2), HasSubstr("a.png: is damaged"));
}

}  // namespace
}  // namespace tubebin
