/// PNG files with 16 bits of grey a pixel, through libpng's older interface, which hands out the bytes as they are.
#pragma once

#include <gtest/gtest.h>
#include <png.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace tubebin::testing {

struct GreyImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> values;
};

inline GreyImage read_grey_png(const std::string& bytes) {
  struct Rest {
    const std::string& bytes;
    std::size_t begin;
  } rest{bytes, 0};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_read_fn(png, &rest, [](png_structp reader, png_bytep data, png_size_t size) {
    auto* from = static_cast<Rest*>(png_get_io_ptr(reader));
    if (from->begin + size > from->bytes.size()) throw std::runtime_error("the PNG file ends too early");
    std::memcpy(data, from->bytes.data() + from->begin, size);
    from->begin += size;
  });
  png_read_info(png, info);
  GreyImage image{
      static_cast<int>(png_get_image_width(png, info)), static_cast<int>(png_get_image_height(png, info)), {}};
  EXPECT_EQ(png_get_bit_depth(png, info), 16);
  EXPECT_EQ(png_get_color_type(png, info), PNG_COLOR_TYPE_GRAY);
  std::vector<png_byte> row(2 * static_cast<std::size_t>(image.width));
  for (int r = 0; r < image.height; ++r) {
    png_read_row(png, row.data(), nullptr);
    for (std::size_t c = 0; c < row.size(); c += 2)  // most significant byte first
      image.values.push_back(static_cast<std::uint16_t>(row[c] << 8 | row[c + 1]));
  }
  png_destroy_read_struct(&png, &info, nullptr);
  return image;
}

/// Without any statement about brightness, as most programs write them.
inline std::string write_grey_png(const GreyImage& image) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp writer, png_bytep data, png_size_t size) {
        static_cast<std::string*>(png_get_io_ptr(writer))->append(reinterpret_cast<const char*>(data), size);
      },
      [](png_structp) {});
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 16,
               PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  std::vector<png_byte> row;
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    row.push_back(static_cast<png_byte>(image.values[i] >> 8));
    row.push_back(static_cast<png_byte>(image.values[i] & 0xFF));
    if (row.size() < 2 * static_cast<std::size_t>(image.width)) continue;
    png_write_row(png, row.data());
    row.clear();
  }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

}  // namespace tubebin::testing
