/* SPDX-License-Identifier: Apache-2.0 */
/* What a bench of one scene found, and its three forms: for people, as JSON, and as rows of the
 * tables of `make bench`. */
#ifndef FRAY_TOOLS_BENCH_RESULT_H
#define FRAY_TOOLS_BENCH_RESULT_H

#include <stdio.h>

#include "tools/bench/scaling.h"
#include "tools/bench/json.h"
#include "tools/bench/profile.h"
#include "tools/bench/projections.h"

typedef struct {
  const char *name;
  uint32_t warps, wefts;
  uint32_t triangles; /* of a membrane, which has no warps and wefts; else 0 */
  size_t memory_bytes;
  kernels kernels;
  profile profiles[KERNELS_MAX];
  projection_times any;  /* all rows */
  projection_times runs; /* rows in long runs alone; rows 0 where there are too few */
} bench_result;

void result_print(FILE *out, const bench_result *r);
void result_json(json *j, const bench_result *r);
void result_table(FILE *out, const bench_result *r);

void scaling_print(FILE *out, const scaling *g);
void scaling_json(json *j, const scaling *g);
void scaling_table(FILE *out, const scaling *g);

void machine_print(FILE *out);
void machine_json(json *j);

#endif
