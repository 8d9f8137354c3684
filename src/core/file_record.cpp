#include "tubebin/core/file_record.hpp"

#include <fmt/format.h>
#include <xxhash.h>

namespace tubebin {

FileRecord record_bytes(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {.bytes = bytes.size(), .xxh128 = fmt::format("{:016x}{:016x}", hash.high64, hash.low64)};
}

}  // namespace tubebin
