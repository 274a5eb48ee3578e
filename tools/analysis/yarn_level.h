/* SPDX-License-Identifier: Apache-2.0 */
/* The memory and the bounds of the yarn level of woven cloth. */
#ifndef FRAY_TOOLS_ANALYSIS_YARN_LEVEL_H
#define FRAY_TOOLS_ANALYSIS_YARN_LEVEL_H

#include <stddef.h>
#include <stdio.h>

#include "rt/fray.h"

typedef struct {
  uint32_t spares;  /* particles */
  uint32_t couples; /* split crossings at most: free ones that get a spare particle */
  uint32_t splits;  /* a tick */
  size_t bytes;     /* of the world's memory, for spare particles, springs and split crossings */
} yarn_level;

/* All 0 without yarns. */
yarn_level yarn_level_of(const fray_world *world);
/* One line; nothing without yarns. */
void yarn_level_print(const fray_world *world, FILE *out);

#endif
