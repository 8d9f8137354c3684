#include <png.h>

#include <stdexcept>

#include "export/scene_image.hpp"

namespace tubebin::exports {
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

std::string png_of(const Raster<std::uint16_t>& image) {
  return encode(image.values.data(), image.width, image.height, PNG_FORMAT_LINEAR_Y);
}

std::string png_of_rgb(const std::vector<std::uint8_t>& rgb, int width, int height) {
  return encode(rgb.data(), width, height, PNG_FORMAT_RGB);
}

}  // namespace tubebin::exports
