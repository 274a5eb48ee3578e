/* SPDX-License-Identifier: Apache-2.0 */
/* Sheets that a bench makes itself: they hang from their top rows, or are torn. */
#ifndef FRAY_TOOLS_BENCH_WOVEN_SAMPLE_H
#define FRAY_TOOLS_BENCH_WOVEN_SAMPLE_H

#include "tools/recording/session.h"

enum { WOVEN_SAMPLE_SUBSTEPS = 4, WOVEN_SAMPLE_TORN_SUBSTEPS = 8, WOVEN_SAMPLE_TORN_TICKS = 160 };

/* Returns 0 iff memory is out. */
int woven_sample_open(uint32_t warps, uint32_t wefts, session *s);

typedef enum { WOVEN_SAMPLE_SPHERES, WOVEN_SAMPLE_CAPSULES } woven_sample_bodies;

/* Torn apart by two balls at its upper corners (figure 6 of Metaaphanon 2009), or by two bars at its
 * sides (figure 11b), whatever its size in the same ticks. `yarns` on or all. Returns 0 iff memory is
 * out. */
int woven_sample_open_torn(uint32_t warps, uint32_t wefts, woven_sample_bodies bodies, const char *yarns, session *s);

#endif
