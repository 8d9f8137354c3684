#include "tubebin/core/file_record.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace tubebin {
namespace {

/// As `xxh128sum` prints it.
TEST(FileRecord, HasTheHashOfTheReferenceProgram) {
  EXPECT_EQ(record_bytes(""), (FileRecord{.bytes = 0, .xxh128 = "99aa06d3014798d86001c324468d497f"}));
}

TEST(FileRecord, DoesNotDependOnTheBlocksInWhichBytesCome) {
  std::string bytes;
  for (int i = 0; i < 10'000; ++i) bytes.push_back(static_cast<char>(i * i % 251));
  for (const std::size_t size : {1UL, 7UL, 256UL, 9'999UL}) {
    FileRecorder recorder;
    for (std::string_view left = bytes; !left.empty(); left.remove_prefix(std::min(size, left.size())))
      recorder.add(left.substr(0, size));
    EXPECT_EQ(recorder.record(), record_bytes(bytes)) << size;
  }
}

}  // namespace
}  // namespace tubebin
