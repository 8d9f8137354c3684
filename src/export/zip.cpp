#include "export/zip.hpp"

#include <zlib.h>

#include <limits>
#include <stdexcept>

namespace tubebin::exports {
namespace {

constexpr std::uint16_t kVersion = 20;           // 2.0
constexpr std::uint16_t kFirstDay = 1 << 5 | 1;  // 1 January 1980, the format's first day

class LittleEndian {
 public:
  LittleEndian& u16(std::size_t value) { return put(value, 2); }
  LittleEndian& u32(std::size_t value) { return put(value, 4); }
  std::string bytes;

 private:
  LittleEndian& put(std::size_t value, int size) {
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
    return *this;
  }
};

std::uint32_t checksum(const std::string& bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

/// What the local header and the directory say alike: version, flags, stored, time, date, checksum, sizes, name's
/// length, no extra field (APPNOTE.TXT 6.3.10, sections 4.3.7 and 4.3.12).
std::string common_header(const std::string& name, const std::string& bytes) {
  return LittleEndian()
      .u16(kVersion)
      .u16(0)
      .u16(0)
      .u16(0)
      .u16(kFirstDay)
      .u32(checksum(bytes))
      .u32(bytes.size())
      .u32(bytes.size())
      .u16(name.size())
      .u16(0)
      .bytes;
}

}  // namespace

std::string format_zip(const Files& files) {
  std::string archive, directory;
  for (const auto& [name, bytes] : files) {
    const std::string common = common_header(name, bytes);
    directory += LittleEndian().u32(0x02014b50).u16(kVersion).bytes + common;
    directory += LittleEndian().u16(0).u16(0).u16(0).u32(0).u32(archive.size()).bytes + name;
    archive += LittleEndian().u32(0x04034b50).bytes + common + name + bytes;
  }
  if (archive.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::length_error("a zip archive of more than 4 GB");
  const std::size_t directory_start = archive.size();
  archive += directory;
  archive += LittleEndian()
                 .u32(0x06054b50)
                 .u16(0)
                 .u16(0)
                 .u16(files.size())
                 .u16(files.size())
                 .u32(directory.size())
                 .u32(directory_start)
                 .u16(0)
                 .bytes;
  return archive;
}

}  // namespace tubebin::exports
