/* SPDX-License-Identifier: Apache-2.0 */
/* Letting a scene come to rest, and finding the substeps (or sweeps) that it needs, by test runs. */
#ifndef FRAY_BUILD_SETTLE_H
#define FRAY_BUILD_SETTLE_H

#include "rt/model/world.h"
#include "tools/build/build.h"

typedef struct {
  const char *file;
  uint32_t rest_ticks;     /* in thick air, before tick 0 */
  uint32_t ticks;          /* of a test run after that; 0: none, substeps and sweeps are given */
  int32_t strain_max_q16;  /* no spring may reach it */
  build_progress *progress;
  void *context;
} settle_plan;

/* Where everything rests at tick 0; particles are malloc'ed. */
typedef struct {
  int32_t *particles[3];
  int32_t bodies[SCENE_BODIES + 1][3];
} settle_rest;

/* Fills report->substeps, sweeps, strain_q16, tries, and the rest. Returns 0 with the error
 * filled. report->searched says whether to look for substeps or sweeps. */
int settle_scene(const scene *s, const settle_plan *plan, build_report *report, settle_rest *rest,
                 scene_error *error);

/* A world at tick 0, in malloc'ed *memory that the caller frees; 0 with the error filled. */
int fill_world(const scene *s, const char *file, uint32_t substeps, uint32_t sweeps, void **memory,
               fray_world **world, scene_error *error);

void scene_refuse(scene_error *error, const char *file, int line, const char *message);

#endif
