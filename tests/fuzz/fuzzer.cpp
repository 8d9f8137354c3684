/// libFuzzer's entry point; TUBEBIN_FUZZ_TARGET names a function of targets.hpp.
#include "fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  tubebin::fuzz::TUBEBIN_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
