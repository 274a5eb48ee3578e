/* SPDX-License-Identifier: Apache-2.0 */
/* From a scene to an image. */
#ifndef FRAY_BUILD_BUILD_H
#define FRAY_BUILD_BUILD_H

#include <stddef.h>
#include <stdint.h>

#include "tools/build/scene.h"

/* What the compiler found; for `fray scene` and `fray info` to print. */
typedef struct {
  uint32_t substeps, sweeps;
  int searched;              /* 1: substeps or sweeps were found by test runs */
  int32_t strain_q16;        /* largest strain in the last half of the test run */
  uint32_t tries;
  uint32_t stretch_steps; /* inner steps of a substep; 0: yarns have no stiffness */
  uint32_t fall_steps;       /* position steps that gravity moves a particle in a substep */
} build_report;

/* Called between test runs, e.g. to show progress; may be NULL. */
typedef void build_progress(void *context, uint32_t substeps, uint32_t sweeps, uint32_t tick, uint32_t ticks);

/* Compiles a scene. On success returns 1 and *image is malloc'ed (caller frees). Integers only:
 * the same bytes on every machine. On failure returns 0 and *error says why. */
int build_image(const scene *s, const char *file, uint8_t **image, size_t *image_bytes, build_report *report,
                build_progress *progress, void *context, scene_error *error);

#endif
