/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/simd/simd.h"

#ifdef SIMD_HAS_X86
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#include "rt/simd/lanes_avx2.h"
#include "rt/simd/kernels.inl.h"

SIMD_DEFINE_SET(avx2)

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
