#pragma once
// Which of Highway's targets are compiled; included before any header of Highway by every file that uses it.
//  - SSSE3, and the AVX-512 variants that add nothing which the sea uses, would only lengthen the build.
//  - 32-bit ARM's NEON flushes subnormals to zero: another sea.
//  - SVE's vectors have no size at compile time and cannot be members of structs.
#include <hwy/detect_compiler_arch.h>
#if defined(HWY_ARCH_ARM_V7) && HWY_ARCH_ARM_V7
#define HWY_DISABLED_TARGETS (HWY_NEON)
#else
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#endif
#include <hwy/detect_targets.h>
