#include "tubebin/core/memory.hpp"

#include <malloc.h>

namespace tubebin {

void keep_memory() {
  constexpr int kLargestThreshold = 32 << 20;  // bytes; glibc takes no larger one
  mallopt(M_MMAP_THRESHOLD, kLargestThreshold);
  mallopt(M_TRIM_THRESHOLD, 8 * kLargestThreshold);
}

}  // namespace tubebin
