/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/simd/simd.h"

#ifdef SIMD_HAS_NEON
#include "rt/simd/lanes_neon.h"
#include "rt/simd/kernels.inl.h"

SIMD_DEFINE_SET(neon)
#endif
