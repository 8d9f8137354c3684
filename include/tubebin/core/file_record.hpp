/// How the bytes of a file are recognized again.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace tubebin {

struct FileRecord {
  std::uint64_t bytes = 0;
  std::string xxh128;  ///< XXH3 128-bit hash in hexadecimal, as the program xxh128sum prints it

  friend bool operator==(const FileRecord&, const FileRecord&) = default;
};

/// Takes the bytes of a file, one block after the other.
using ByteSink = std::function<void(std::string_view)>;

/// Size and hash of bytes that come in blocks.
class FileRecorder {
 public:
  FileRecorder();
  ~FileRecorder();
  FileRecorder(const FileRecorder&) = delete;
  FileRecorder& operator=(const FileRecorder&) = delete;

  void add(std::string_view block);
  FileRecord record() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Size and hash of a file's bytes.
FileRecord record_bytes(std::string_view bytes);

}  // namespace tubebin
