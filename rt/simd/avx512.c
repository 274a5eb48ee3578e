/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/simd/simd.h"

#ifdef SIMD_HAS_X86
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512bw,avx512dq,avx512vl"))), \
                             apply_to = function)
#else
#pragma GCC target("avx512f,avx512bw,avx512dq,avx512vl")
#endif
#include "rt/simd/lanes_avx512.h"
#include "rt/simd/kernels.inl.h"

SIMD_DEFINE_SET(avx512)

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
