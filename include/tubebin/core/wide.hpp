/// Functions that use wider registers where the processor has them.
#pragma once

// TUBEBIN_WIDE before a function's definition: it is compiled for AVX2 too, and the processor decides which of both runs.
// The order of operations is the same in both, and nothing is fused (-ffp-contract=off), so the results are the same to
// the bit. The sanitizers' runtimes are not ready when the choice is made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define TUBEBIN_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define TUBEBIN_WIDE
#endif
