/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles of a sheet that meet each other (Karaoz 2015, section 2.6): what a tick works with. Constants are
 * those of self-collision (selves.h). */
#ifndef FRAY_MODEL_LAYERS_H
#define FRAY_MODEL_LAYERS_H

#include "rt/model/selves.h"

enum {
  LIMIT_LAYERS = 1 << 22,
  LAYERS_CELLS = 2,   /* a triangle */
  LAYERS_KINDS = 6,   /* of pairs of a vertex and a triangle; above that two sides */
  LAYERS_LOOKS = SELVES_PASSES + 2 /* at bodies, behind each pass */
};

#define LAYERS_NOBODY ((row_id)~0u)

/* A vertex p[0] and a triangle, or two sides, that are near each other. They are ordered by the triangle that
 * has the first, then by the key: the other triangle, and which of both it is. */
typedef struct {
  row_id p[4];
  uint32_t key;
  int32_t until;  /* how far all may go, listed.path, before they can meet */
  uint8_t sides;  /* 1: p[0], p[1] and p[2], p[3] are sides */
  uint8_t kin;    /* a tear has made two of a vertex that both had */
  uint8_t looked; /* as of self_pair */
  uint8_t near;
} layer_pair;

typedef struct {
  int32_t low[3], high[3];
  uint32_t cell[3];
  uint32_t own; /* bits 0 to 2: vertices that are this triangle's to look at, 3 to 5: sides */
} layer_box;

/* Of the pairs that are listed. */
typedef struct {
  uint32_t kept;     /* they may be there still */
  uint32_t pairs, met;
  uint32_t tight, lacks, full; /* while they are listed: only for this tick; there is no room for one; others are joined */
  uint32_t particles;
  int32_t topology[2];
  int32_t reach;     /* what is nearer to each other is listed */
  int32_t path;      /* how far anything has gone since, but for what all have */
  int32_t spread;    /* and goes in this tick */
} layer_list;

#endif
