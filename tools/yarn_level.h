/* SPDX-License-Identifier: Apache-2.0 */
/* What the yarn level of a sheet takes at most. */
#ifndef FRAY_TOOLS_YARN_LEVEL_H
#define FRAY_TOOLS_YARN_LEVEL_H

#include <stddef.h>
#include <stdio.h>

#include "rt/fray.h"

typedef struct {
  uint32_t spares;  /* particles */
  uint32_t couples; /* at most: free crossings that find a spare particle */
  uint32_t splits;  /* a tick */
  size_t bytes;     /* of the world's memory: spare particles, shadow rows, couples */
} yarn_level;

/* All 0 of a sheet without yarns. */
yarn_level yarn_level_of(const fray_world *world);
/* One line, nothing of a sheet without yarns. */
void yarn_level_print(const fray_world *world, FILE *out);

#endif
