/* SPDX-License-Identifier: Apache-2.0 */
/* Sheets that a bench makes itself: they hang from their top rows. */
#ifndef FRAY_BENCH_SHEETS_H
#define FRAY_BENCH_SHEETS_H

#include "tools/session.h"

enum { SHEET_SUBSTEPS = 4 };

/* Returns 0 iff memory is out. */
int sheet_open(uint32_t warps, uint32_t wefts, session *s);

#endif
