/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles of a sheet that meet each other (Karaoz 2015, section 2.6): what a tick works with. Constants are
 * those of self-collision (selves.h). */
#ifndef FRAY_MODEL_LAYERS_H
#define FRAY_MODEL_LAYERS_H

#include "rt/model/selves.h"

enum {
  LIMIT_LAYERS = 1 << 22,
  LAYERS_CELLS = 2,   /* a triangle */
  LAYERS_CORNERS = 6, /* kinds of pairs of a vertex and a triangle; above that two sides */
  LAYERS_LOOKS = SELVES_PASSES + 2 /* at bodies, behind each pass */
};
#define LAYERS_NOBODY ((row_id)~0u)

/* A vertex p[0] and a triangle, or two sides, that are near each other, and the triangles that have to look at
 * them: `of` with the greater number first. */
typedef struct {
  int32_t until;  /* how far both may go together, layer_way.path, before they can meet */
  row_id of[2];
  row_id p[4];
  uint8_t kind;   /* to LAYERS_CORNERS - 1: a vertex of the first, then of the second; then sides, 3 m + n */
  uint8_t kin;    /* a tear has made two of a vertex that both had */
  uint8_t looked; /* as of self_pair */
  uint8_t near;
} layer_pair;
static inline uint32_t layer_firsts(const layer_pair *of) { return of->kind < LAYERS_CORNERS ? 1u : 2u; }

/* A triangle where it is, and as much around it as it may go until it is looked at again. */
typedef struct {
  int32_t low[3], high[3];
  uint32_t cell[3];
  uint32_t own; /* bits 0 to 2: vertices that are this triangle's to look at, 3 to 5: sides */
} layer_box;

/* How far a triangle has gone, by the farthest of its corners, beside the mean of all; Q24 lu. */
typedef struct {
  int32_t path;  /* since all were listed */
  int32_t limit; /* of path: all that it may meet until then is listed */
  int32_t room;  /* of it, when it was listed */
} layer_way;

/* Of the pairs that are listed. */
typedef struct {
  uint32_t kept;   /* they may be there still */
  uint32_t pairs, met;
  uint32_t particles;
  int32_t topology[2];
  int32_t usual;   /* how far a triangle may go until it is listed again, if it is not fast */
  uint32_t cells, wide, stale;
  int32_t cell;    /* how wide one is, Q24 lu */
  uint32_t tight, lacks, full; /* only what may meet in this tick; there is no room for one; others are joined */
} layer_list;

#endif
