/* SPDX-License-Identifier: Apache-2.0 */
/* The pieces of torn cloth: particles connected by unbroken structural springs and by crossings that are
 * not disconnected; of a membrane vertices connected by triangles. */
#ifndef FRAY_TOOLS_ANALYSIS_COMPONENTS_H
#define FRAY_TOOLS_ANALYSIS_COMPONENTS_H

#include "rt/fray.h"

typedef struct {
  uint32_t crossings; /* with yarns particles, of a membrane vertices */
  uint32_t holders;   /* bit b: some of it is attached to body b; 0: free */
} component;

/* Writes the pieces, largest first, into out[room]; returns how many there are, or 0 iff memory
 * ran out. */
uint32_t components_find(const fray_world *world, component *out, uint32_t room);

#endif
