#include "tubebin/core/utf8.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace tubebin {

bool is_utf8(std::string_view text) {
  // The lowest code point that needs so many bytes.
  constexpr std::array<std::uint32_t, 5> kLowest = {0, 0, 0x80, 0x800, 0x10000};
  while (!text.empty()) {
    const auto first = static_cast<unsigned char>(text.front());
    const std::size_t bytes = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
    if (bytes == 0 || text.size() < bytes) return false;
    std::uint32_t code = bytes == 1 ? first : first & (0x7fU >> bytes);
    for (const char next : text.substr(1, bytes - 1)) {
      if ((static_cast<unsigned char>(next) & 0xc0U) != 0x80) return false;
      code = code << 6 | (static_cast<unsigned char>(next) & 0x3fU);
    }
    if (code < kLowest[bytes] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return false;
    text.remove_prefix(bytes);
  }
  return true;
}

}  // namespace tubebin
