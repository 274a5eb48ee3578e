/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wide/wide.h"

#ifdef WIDE_HAS_HELIUM
/* gcc makes no vectors of plain loops below this, and keeps small arrays of lanes in memory */
#pragma GCC optimize("O3")
#include "rt/wide/lanes_helium.h"
#include "rt/wide/kernels.h"

WIDE_TABLE(WIDE_DEFINE, helium)
#endif
