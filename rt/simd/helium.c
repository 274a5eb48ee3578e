/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/simd/simd.h"

#ifdef SIMD_HAS_HELIUM
/* gcc makes no vectors of plain loops below this, and keeps small arrays of lanes in memory */
#pragma GCC optimize("O3")
#include "rt/simd/lanes_helium.h"
#include "rt/simd/kernels.inl.h"

SIMD_DEFINE_SET(helium)
#endif
