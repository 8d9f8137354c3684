#include "core/png.hpp"

#include <png.h>

#include <stdexcept>

#include "tubebin/core/error.hpp"

namespace tubebin {
namespace {

std::string encode(const void* pixels, int width, int height, png_uint_32 format) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(width);
  header.height = static_cast<png_uint_32>(height);
  header.format = format;
  header.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, pixels, 0, nullptr))
    throw std::runtime_error(std::string("can't encode a PNG image: ") + header.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace

std::string encode_rgb_png(const std::vector<std::uint8_t>& rgb, int width, int height) {
  return encode(rgb.data(), width, height, PNG_FORMAT_RGB);
}

std::string encode_grey_png(const std::vector<std::uint16_t>& grey, int width, int height) {
  return encode(grey.data(), width, height, PNG_FORMAT_LINEAR_Y);
}

std::vector<std::uint16_t> decode_grey_png(std::string_view bytes, const std::string& name, int width, int height) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()))
    throw_io_error("{}: is no PNG image: {}", name, header.message);
  const bool is_expected = header.format == PNG_FORMAT_LINEAR_Y && header.width == static_cast<png_uint_32>(width) &&
                           header.height == static_cast<png_uint_32>(height);
  if (!is_expected) {
    png_image_free(&header);
    throw_io_error("{}: {} x {} pixels{}; valid: {} x {} pixels with 16 bits of grey each", name, header.width,
                   header.height, header.format == PNG_FORMAT_LINEAR_Y ? "" : " of another kind", width, height);
  }
  std::vector<std::uint16_t> grey(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  if (!png_image_finish_read(&header, nullptr, grey.data(), 0, nullptr))
    throw_io_error("{}: is damaged: {}", name, header.message);
  return grey;
}

}  // namespace tubebin
