/* SPDX-License-Identifier: Apache-2.0 */
/* Sheets that a bench makes itself: they hang from their top rows, or are torn. */
#ifndef FRAY_BENCH_SHEETS_H
#define FRAY_BENCH_SHEETS_H

#include "tools/session.h"

enum { SHEET_SUBSTEPS = 4, SHEET_TORN_SUBSTEPS = 8, SHEET_TORN_TICKS = 160 };

/* Returns 0 iff memory is out. */
int sheet_open(uint32_t warps, uint32_t wefts, session *s);

typedef enum { SHEET_BALLS, SHEET_BARS } sheet_grips;

/* Torn apart by two balls at its upper corners (figure 6 of Metaaphanon 2009), or by two bars at its
 * sides (figure 11b), whatever its size in the same ticks. `yarns` on or all. Returns 0 iff memory is
 * out. */
int sheet_open_torn(uint32_t warps, uint32_t wefts, sheet_grips grips, const char *yarns, session *s);

#endif
