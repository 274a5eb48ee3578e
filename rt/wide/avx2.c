/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wide/wide.h"

#ifdef WIDE_HAS_X86
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#include "rt/wide/lanes_avx2.h"
#include "rt/wide/kernels.h"

WIDE_TABLE(WIDE_DEFINE, avx2)

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
