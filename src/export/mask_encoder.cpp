#include "export/mask_encoder.hpp"

#include <zlib.h>

#include <stdexcept>

namespace tubebin::exports {
namespace {

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xFFU);
  return bytes;
}

const Bytef* bytes_of(const std::string& text) { return reinterpret_cast<const Bytef*>(text.data()); }

std::string chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const uLong crc = crc32_z(0, bytes_of(body), body.size());
  return big_endian(static_cast<std::uint32_t>(data.size())) + body + big_endian(static_cast<std::uint32_t>(crc));
}

}  // namespace

MaskEncoder::MaskEncoder(int width, int height) : width_(width), height_(height) {
  const std::size_t row = static_cast<std::size_t>(width) + 1;
  for (std::size_t count = 1; count <= static_cast<std::size_t>(height); count *= 2)
    empty_rows_.push_back(deflate(std::string(count * row, '\0')));
}

MaskEncoder::Part MaskEncoder::deflate(const std::string& bytes) {
  constexpr int kRawWindowBits = -15, kMemoryLevel = 8;
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kRawWindowBits, kMemoryLevel, Z_RLE) != Z_OK)
    throw std::runtime_error("zlib can't begin a stream");
  constexpr std::size_t kFlush = 16;  // bytes, more than the end of a part takes
  Part part{.deflated = std::string(deflateBound(&stream, bytes.size()) + kFlush, '\0'), .size = bytes.size()};
  stream.next_in = const_cast<Bytef*>(bytes_of(bytes));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(part.deflated.data());
  stream.avail_out = static_cast<uInt>(part.deflated.size());
  ::deflate(&stream, Z_FULL_FLUSH);
  part.deflated.resize(part.deflated.size() - stream.avail_out);
  deflateEnd(&stream);
  part.adler32 = static_cast<std::uint32_t>(adler32_z(1, bytes_of(bytes), bytes.size()));
  return part;
}

void MaskEncoder::append(Part& stream, const Part& part) {
  stream.deflated += part.deflated;
  stream.adler32 =
      static_cast<std::uint32_t>(adler32_combine(stream.adler32, part.adler32, static_cast<z_off_t>(part.size)));
  stream.size += part.size;
}

void MaskEncoder::append_empty_rows(Part& stream, int count) const {
  for (std::size_t i = 0; i < empty_rows_.size(); ++i)
    if ((count >> i & 1) != 0) append(stream, empty_rows_[i]);
}

/// Each with PNG's filter 0, "none", before it.
std::string MaskEncoder::rows_of(const Mask& mask, int begin, int end) const {
  const auto width = static_cast<std::size_t>(width_);
  std::string rows(static_cast<std::size_t>(end - begin) * (width + 1), '\0');
  for (const std::uint32_t pixel : mask.pixels)
    rows[(pixel / width - static_cast<std::size_t>(begin)) * (width + 1) + 1 + pixel % width] = '\xFF';
  return rows;
}

std::string MaskEncoder::png_of(const Mask& mask) const {
  Part stream;
  if (mask.pixels.empty()) {
    append_empty_rows(stream, height_);
  } else {
    const PixelBox box = box_of(mask);
    append_empty_rows(stream, box.y);
    append(stream, deflate(rows_of(mask, box.y, box.y + box.height)));
    append_empty_rows(stream, height_ - box.y - box.height);
  }
  const std::string deflate_header = {'\x78', '\x01'}, last_block = {'\x03', '\x00'};
  const std::string grey_8_bit = {'\x08', '\x00', '\x00', '\x00', '\x00'};
  return "\x89PNG\r\n\x1a\n" +
         chunk("IHDR", big_endian(static_cast<std::uint32_t>(width_)) +
                           big_endian(static_cast<std::uint32_t>(height_)) + grey_8_bit) +
         chunk("IDAT", deflate_header + stream.deflated + last_block + big_endian(stream.adler32)) + chunk("IEND", "");
}

}  // namespace tubebin::exports
