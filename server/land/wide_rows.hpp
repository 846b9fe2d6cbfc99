#pragma once
#include <cstddef>

/// Put before a function whose loops over rows gain from wide vector registers: where compiler and system choose between copies of a
/// function when a program starts, it is compiled for AVX-512 and AVX2 too. FMA stays off in all of them, so the results are the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__linux__) &&                 \
    defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TROCHOID_WIDE_ROWS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define TROCHOID_WIDE_ROWS
#endif
