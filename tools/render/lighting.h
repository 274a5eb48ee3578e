/* SPDX-License-Identifier: Apache-2.0 */
/* One key light that casts shadows, a fill light, and light from sky and ground. */
#ifndef FRAY_TOOLS_RENDER_LIGHTING_H
#define FRAY_TOOLS_RENDER_LIGHTING_H

#include "tools/render/camera.h"
#include "tools/render/canvas.h"
#include "tools/render/vec3.h"

typedef struct {
  v3 key, fill; /* unit, towards the lights */
  camera sun;   /* looks along the key light */
  canvas map;   /* depths seen from there */
  float reach;  /* mm: how far a surface lifts its questions off itself */
} lighting;

typedef struct {
  rgb colour;
  float sheen;   /* the soft rim of fibres seen edge on */
  float gloss;   /* a highlight */
  float through; /* share of the key light that passes from behind */
} surface_material;

/* A yarn at a point: a surface for Lambert, a bundle of fibres for Kajiya and Kay. */
typedef struct {
  rgb colour;
  v3 along, normal;
  v3 smooth;    /* the shape without the yarn's own roundness; faces the viewer */
  float open;   /* share of the light around that reaches in between the yarns */
  float thread; /* 0 a surface, 1 a fibre */
  float gloss;
} fibre;

/* Returns 0 iff memory ran out. `over` is everything that casts or receives shadow. */
int lighting_open(lighting *l, bounds over, float reach_mm, uint32_t map_side);
void lighting_close(lighting *l);

/* 1 in full key light, 0 in shadow; soft at the edge. `normal` is where the viewer is. */
float lighting_visibility(const lighting *l, v3 at, v3 normal);
rgb lighting_shade_fibre(const lighting *l, const fibre *f, v3 at, v3 towards);
rgb lighting_shade(const lighting *l, const surface_material *m, v3 at, v3 normal, v3 smooth, v3 towards);

#endif
