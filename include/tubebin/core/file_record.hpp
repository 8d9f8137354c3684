/// How the bytes of a file are recognized again.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace tubebin {

struct FileRecord {
  std::uint64_t bytes = 0;
  std::string xxh128;  ///< XXH3 128-bit hash in hexadecimal, as the program xxh128sum prints it

  friend bool operator==(const FileRecord&, const FileRecord&) = default;
};

/// Size and hash of a file's bytes.
FileRecord record_bytes(std::string_view bytes);

}  // namespace tubebin
