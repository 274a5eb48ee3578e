/* SPDX-License-Identifier: Apache-2.0 */
/* From a scene to an image. */
#ifndef FRAY_TOOLS_SCENE_COMPILER_COMPILE_H
#define FRAY_TOOLS_SCENE_COMPILER_COMPILE_H

#include <stddef.h>
#include <stdint.h>

#include "tools/scene_language/scene.h"

/* What sets the strain that cloth may have at rest. */
typedef enum { REST_BY_MAX, REST_BY_TEAR, REST_BY_SPLIT } rest_limit;

/* For `fray scene` and `fray info` to print. */
typedef struct {
  uint32_t substeps, iterations;
  int searched;              /* 1: substeps or iterations were found by test runs */
  int32_t strain_q16;        /* largest strain in the test run */
  int32_t strain_max_q16;    /* every spring is to stay below; 0: a membrane */
  rest_limit limit;          /* what says so */
  uint32_t tries;
  exact default_bend, default_shear; /* g/s2; 0: woven cloth gives it, or there is none */
  uint32_t stretch_steps; /* elastic steps of a substep; 0: inextensible yarns */
  uint32_t fall_steps;       /* units of position by which gravity moves a particle in a substep */
} compile_report;

/* Called between test runs, e.g. to show progress; may be NULL. */
typedef void compile_progress(void *context, uint32_t substeps, uint32_t iterations, uint32_t tick,
                              uint32_t ticks);

/* Compiles a scene. On success returns 1 and *image is malloc'ed (caller frees). Integers only:
 * the same bytes on every machine. On failure returns 0 and *error says why. */
int compile_image(const scene *s, const char *file, uint8_t **image, size_t *image_bytes,
                  compile_report *report, compile_progress *progress, void *context, scene_error *error);

/* The test run of `auto` with the substeps and iterations that a scene of woven cloth gives itself: fills
 * report->strain_q16. report is compile_image()'s, with nothing searched. Returns 0 with *error filled. */
int compile_rest_strain(const scene *s, const char *file, compile_report *report, compile_progress *progress,
                        void *context, scene_error *error);

#endif
