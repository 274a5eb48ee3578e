/* SPDX-License-Identifier: Apache-2.0 */
/* What tears and cuts do to a sheet (Karaoz 2015, sections 2.7 and 3.3). Each happens whole, or says
 * why it cannot and changes nothing.
 *
 * - No vertex is left with two fans: where a side is opened and an end of it lies at a border already,
 *   that end becomes two vertices. Both stand where the old one stood, with its velocity, each with the
 *   mass of its own triangles.
 * - No sliver is made: a ray that would divide a triangle into parts below the least area or height
 *   goes along the nearer of its sides instead, or along the other one where that is a border.
 * - Held vertices are never made two: what grips one grips both sides. A tear ends before them.
 *
 * Predicted positions follow the positions; the derived arrays and the topology's hash are kept. */
#ifndef FRAY_MODEL_SHEET_SPLIT_H
#define FRAY_MODEL_SHEET_SPLIT_H

#include "rt/model/world.h"

typedef enum {
  SHEET_DONE = 0,
  SHEET_NO_PARTICLES, /* not enough spare particles */
  SHEET_NO_TRIANGLES, /* not enough spare triangles */
  SHEET_NO_WAY        /* a border, a held vertex, a full fan, or a sliver is in its way */
} sheet_result;

/* `share` of the way from a to b, Q16, rounded. */
enum { SHEET_SHARE = 1 << 16 };
sheet_point sheet_between(sheet_point a, sheet_point b, uint32_t share);
/* The point of a triangle with these weights of corners 0 and 1, Q16; corner 2 has the rest. */
sheet_point sheet_within(const sheet_mesh *s, uint32_t t, uint32_t share0, uint32_t share1);

/* From a vertex through triangle n of its fan to the side opposite: at `share` of the way from spoke n
 * to spoke n + 1, Q16; 0 is along spoke n. */
typedef struct {
  uint32_t n;
  uint32_t share;
} sheet_ray;

/* The ray in a direction of rest coordinates, |du|, |dv| <= 2^30. 0 iff it leaves an open fan. */
int sheet_ray_along(const sheet_mesh *s, const sheet_fan *fan, sheet_point centre, int32_t du, int32_t dv,
                    sheet_ray *ray);

/* Splits a vertex: of a closed fan along two rays, of an open one along the first alone. */
sheet_result sheet_split(fray_world *w, uint32_t vertex, const sheet_ray *from, const sheet_ray *to,
                         sheet_mark mark);

/* Whether that would be done if the pools had room; and along `from` itself, or a side beside it. */
typedef enum { SHEET_FITS_NOT = 0, SHEET_FITS_BESIDE, SHEET_FITS } sheet_fit;
sheet_fit sheet_can_split(const fray_world *w, uint32_t vertex, const sheet_ray *from,
                          const sheet_ray *to);

/* Opens side k, that has a triangle across it: an end at a border becomes two vertices. */
sheet_result sheet_open_side(fray_world *w, uint32_t t, uint32_t k, sheet_mark mark);

/* 1 iff no part is a sliver and no fan is full. */
int sheet_can_divide_side(const sheet_mesh *s, uint32_t t, uint32_t k, uint32_t share);
int sheet_can_divide_triangle(const sheet_mesh *s, uint32_t t, uint32_t share0, uint32_t share1);
/* A new vertex on side k, `share` of the way from corner k + 1 to k + 2. */
sheet_result sheet_divide_side(fray_world *w, uint32_t t, uint32_t k, uint32_t share,
                               uint32_t *born);
/* A new vertex in a triangle. */
sheet_result sheet_divide_triangle(fray_world *w, uint32_t t, uint32_t share0, uint32_t share1,
                                   uint32_t *born);

/* Marks a triangle as one in which a blade may be, or takes that back. */
void sheet_part(fray_world *w, uint32_t t, int parted);

/* The vertices around which a cut opened the sheet: all that became two, with what they became; the first is
 * where the blade was. */
enum { SHEET_LIPS = 10 };
typedef struct {
  uint32_t count;
  uint32_t vertex[SHEET_LIPS];
} sheet_lips;

/* A sharp edge through side k: the side is divided where they met, and the cloth opened from there to
 * both sides along the edge's way. Near an end of the side, or where the parts would be slivers, the
 * nearer end is split instead. */
sheet_result sheet_cut_side(fray_world *w, uint32_t t, uint32_t k, uint32_t share, int32_t du,
                            int32_t dv, sheet_lips *lips);
/* A sharp point through a triangle: three new sides from there to its corners, all open. Near a side,
 * that is divided and opened as by sheet_cut_side() along (du, dv). */
sheet_result sheet_cut_triangle(fray_world *w, uint32_t t, uint32_t share0, uint32_t share1,
                                int32_t du, int32_t dv, sheet_lips *lips);

#endif
