/* SPDX-License-Identifier: Apache-2.0 */
/* The pieces of a torn sheet: crossings connected by structural springs that are whole, and by couples
 * whose yarns still hold each other; of a triangle sheet vertices connected by triangles. */
#ifndef FRAY_TOOLS_PIECES_H
#define FRAY_TOOLS_PIECES_H

#include "rt/fray.h"


typedef struct {
  uint32_t crossings; /* of sheets with yarns, and of triangles, particles */
  uint32_t holders; /* bit b: body b holds some of it; 0: it is loose */
} piece;

/* Writes the pieces, largest first, into out[room]; returns how many there are, or 0 iff memory
 * ran out. */
uint32_t pieces_find(const fray_world *world, piece *out, uint32_t room);

#endif
