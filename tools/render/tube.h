/* SPDX-License-Identifier: Apache-2.0 */
/* A yarn as a tube of elliptic rings, drawn ring by ring. */
#ifndef FRAY_TOOLS_RENDER_TUBE_H
#define FRAY_TOOLS_RENDER_TUBE_H

#include "tools/render/camera.h"
#include "tools/render/canvas.h"
#include "tools/render/cloth_style.h"
#include "tools/render/lighting.h"

enum { TUBE_SIDES_MAX = 12 };

typedef struct {
  v3 at, along;  /* the centre, and the unit direction of the yarn */
  v3 up;         /* unit: out of the cloth, to either side */
  v3 away;       /* from the yarn that crosses here; as long as it is near, 0..1 */
  float tight;   /* 1: lies in cloth, 0: a thread in the air */
  float wide, thick; /* half axes, mm */
  float length;  /* from the yarn's beginning, in mm */
  float load;    /* for colour by strain */
  float alpha;
} tube_ring;

typedef struct {
  canvas *c;
  const camera *cam;
  const lighting *light; /* NULL: depth only */
  rgb colour;
  int strain;            /* colour by load instead */
  float texture;         /* 0..1: how much of its twist shows */
  float ply;             /* mm from one ply to the next */
  uint32_t sides;        /* set by tube_shape() */
  float cosine[TUBE_SIDES_MAX], sine[TUBE_SIDES_MAX];
  canvas_vertex ring[2][TUBE_SIDES_MAX + 1];
  int now, has_ring;
} tube;

void tube_shape(tube *t, uint32_t sides); /* 4..TUBE_SIDES_MAX */
/* Begins anew: the next ring is not joined to the last one. */
static inline void tube_begin(tube *t) { t->has_ring = 0; }
void tube_add(tube *t, const tube_ring *ring);

#endif
