#pragma once
#include <cfloat>

// The sea is defined by float32 + - * / sqrt, each rounded on its own, in the written order. A build that
// contracts products into fused multiply-adds, reorders sums or keeps excess precision computes another sea.
#if defined(__FAST_MATH__)
#error "Trochoid's model must not be built with -ffast-math: remove it from the compiler flags"
#endif
#if FLT_EVAL_METHOD != 0
#error "Trochoid's model needs FLT_EVAL_METHOD 0: on 32-bit x86 add -msse2 -mfpmath=sse"
#endif
static_assert(sizeof(float) == 4 && FLT_MANT_DIG == 24, "float must be IEEE 754 binary32");
static_assert(sizeof(double) == 8 && DBL_MANT_DIG == 53, "double must be IEEE 754 binary64");
