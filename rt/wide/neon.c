/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wide/wide.h"

#ifdef WIDE_HAS_NEON
#include "rt/wide/lanes_neon.h"
#include "rt/wide/kernels.h"

WIDE_TABLE(WIDE_DEFINE, neon)
#endif
