/* SPDX-License-Identifier: Apache-2.0 */
/* What a picture needs of a world, in millimetres and floats: the only file of tools/render that
 * knows rt/fray.h. Tests and drivers may fill it by hand instead. */
#ifndef FRAY_TOOLS_RENDER_PICTURE_SOURCE_H
#define FRAY_TOOLS_RENDER_PICTURE_SOURCE_H

#include <stdint.h>

#include "rt/fray.h"
#include "tools/render/camera.h"
#include "tools/render/vec3.h"

enum { SPRING_NONE = 0, SPRING_ALIVE = 1, SPRING_CUT = 2 };
enum { AXIS_WEFT = 0, AXIS_WARP = 1, AXES = 2 };

typedef struct {
  fray_shape shape;
  fray_motion motion;
  uint32_t hand;
  float radius;
  v3 half, axes[3], position;
  fray_mesh mesh; /* of the world, which outlives the picture; no faces where it is none */
  float mm;       /* of a step of its points */
} picture_body;

typedef struct {
  uint32_t vertex[3];
  float stress;    /* the larger principal one, N/m; < 0: pressed */
  float strength;  /* N/m: of its material, in its weakest direction; 0: it never tears */
  uint8_t border[3], side[3]; /* of the side opposite each vertex: fray_triangle */
} picture_triangle;

typedef struct {
  uint32_t warps, wefts;
  uint32_t weave_columns, weave_rows;
  uint64_t weave;
  float spacing;   /* mean rest length */
  float thickness; /* of the cloth */
  v3 *crossings;   /* [j * warps + i]; of a split one the middle between its two particles */
  uint8_t *split;  /* per crossing: its yarns have a particle each */
  v3 *half_gap;      /* half the way from the weft's particle to the warp's; 0 where not split */
  uint8_t *touching; /* per split crossing: its yarns hold each other, at */
  float *place[AXES]; /* a place on each: points from the yarn's first one */
  uint8_t *pinned; /* per crossing: held in place by an anchor */
  uint8_t *springs; /* SPRING_*, by canonical number, see fray_weave */
  float *load;     /* per spring: strain over the strain at which it is cut; < 0: slack */
  v3 *vertices;    /* of a membrane, which has no crossings */
  uint8_t *held;   /* per vertex: by an anchor */
  picture_triangle *triangles;
  uint32_t vertex_count, triangle_count;
  picture_body *bodies;
  uint32_t body_count;
  uint64_t tick;
  uint32_t rate_hz;
} picture_source;

uint32_t picture_springs(uint32_t warps, uint32_t wefts);

/* Both return 0 iff memory ran out. */
int picture_source_reserve(picture_source *s, uint32_t warps, uint32_t wefts, uint32_t bodies);
int picture_source_read(picture_source *s, const fray_world *world); /* s zeroed or read before */
void picture_source_close(picture_source *s);

/* A point of a body's mesh. */
v3 picture_mesh_point(const picture_body *b, uint32_t point);

bounds picture_source_bounds(const picture_source *s);

/* Canonical number of the spring from (i, j) to (i+1, j), and to (i, j+1);
 * UINT32_MAX outside the grid. */
uint32_t picture_weft_spring(const picture_source *s, uint32_t i, uint32_t j);
uint32_t picture_warp_spring(const picture_source *s, uint32_t i, uint32_t j);
int picture_alive(const picture_source *s, uint32_t spring); /* 0 for UINT32_MAX */
int picture_cell_closed(const picture_source *s, uint32_t i, uint32_t j);
int picture_warp_over(const picture_source *s, uint32_t i, uint32_t j);

#endif
