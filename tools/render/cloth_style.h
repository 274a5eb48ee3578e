/* SPDX-License-Identifier: Apache-2.0 */
/* How cloth is shown, and the colours of its yarns. */
#ifndef FRAY_TOOLS_RENDER_CLOTH_STYLE_H
#define FRAY_TOOLS_RENDER_CLOTH_STYLE_H

#include "tools/render/canvas.h"

typedef enum {
  LOOK_SURFACE, /* closed cells as a woven surface, everything beside an open cell as single yarns */
  LOOK_YARN,  /* every yarn by itself, interleaved with the others */
  LOOK_WIRE   /* living springs: what has split into yarns in one colour, the rest in another */
} cloth_look;

typedef struct {
  cloth_look look;
  rgb warp, weft;
  rgb back;    /* the other side's colours are multiplied by this; LOOK_SURFACE only */
  rgb base, split; /* LOOK_WIRE */
  int strain;  /* 1: blue (slack), white (at rest), red (about to be cut) */
  float stress_full; /* N/m: what is red then, of membranes that never tear */
} cloth_style;

cloth_style cloth_style_default(cloth_look look);
rgb cloth_strain_colour(float load); /* -1..1 */

/* 0..1 from a number alone, so that pictures of a run agree. */
float cloth_random(uint32_t n);
/* Every yarn is a little different. */
rgb cloth_yarn_colour(const cloth_style *style, int warp, uint32_t number);

#endif
