/* SPDX-License-Identifier: Apache-2.0 */
/* Brings a scene to rest, and finds the substeps (or iterations) that it needs, by test runs. */
#ifndef FRAY_TOOLS_SCENE_COMPILER_SETTLE_H
#define FRAY_TOOLS_SCENE_COMPILER_SETTLE_H

#include "rt/state/world.h"
#include "tools/scene_compiler/compile.h"

typedef struct {
  const char *file;
  uint32_t rest_ticks;     /* with strong drag, before tick 0 */
  uint32_t ticks;          /* of a test run after that; 0: none, as substeps and iterations are given */
  int32_t strain_max_q16;  /* every spring stays below */
  exact strain_max;        /* the same */
  compile_progress *progress;
  void *context;
} settle_request;

/* At tick 0: places, and how membranes are bent; malloc'ed but for bodies. */
typedef struct {
  int32_t *particles[3];
  bend_state *bends; /* of triangles; NULL: none */
  int32_t bodies[SCENE_BODIES + 1][3];
} settle_rest;

/* Fills report->substeps, iterations, strain_q16, tries, and the rest. Returns 0 with the error
 * filled. report->searched says whether to look for substeps or iterations. */
int settle_scene(const scene *s, const settle_request *plan, compile_report *report, settle_rest *rest,
                 scene_error *error);

/* A world at tick 0, in malloc'ed *memory that the caller frees; 0 with the error filled. */
int compile_world(const scene *s, const char *file, uint32_t substeps, uint32_t iterations, void **memory,
               fray_world **world, scene_error *error);

void scene_refuse(scene_error *error, const char *file, scene_place place, const char *message);

#endif
