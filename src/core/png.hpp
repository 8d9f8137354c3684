// PNG files in memory. Equal pixels give equal bytes, where libpng and zlib are of the same version.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tubebin {

/// Rows from the top, three bytes (red, green, blue) a pixel.
std::string encode_rgb_png(const std::vector<std::uint8_t>& rgb, int width, int height);

/// Rows from the top, 16 bits of grey a pixel.
std::string encode_grey_png(const std::vector<std::uint16_t>& grey, int width, int height);

/// The pixels of a file of this size with 16 bits of grey a pixel. Throws IoError, which calls the file `name`.
std::vector<std::uint16_t> decode_grey_png(std::string_view bytes, const std::string& name, int width, int height);

}  // namespace tubebin
