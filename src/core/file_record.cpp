#include "tubebin/core/file_record.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <new>

namespace tubebin {

struct FileRecorder::State {
  XXH3_state_t* hash = XXH3_createState();
  std::uint64_t bytes = 0;

  State() {
    if (hash == nullptr) throw std::bad_alloc();
    XXH3_128bits_reset(hash);
  }
  ~State() { XXH3_freeState(hash); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

FileRecorder::FileRecorder() : state_(std::make_unique<State>()) {}
FileRecorder::~FileRecorder() = default;

void FileRecorder::add(std::string_view block) {
  XXH3_128bits_update(state_->hash, block.data(), block.size());
  state_->bytes += block.size();
}

FileRecord FileRecorder::record() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->hash);
  return {.bytes = state_->bytes, .xxh128 = fmt::format("{:016x}{:016x}", hash.high64, hash.low64)};
}

FileRecord record_bytes(std::string_view bytes) {
  FileRecorder recorder;
  recorder.add(bytes);
  return recorder.record();
}

}  // namespace tubebin
