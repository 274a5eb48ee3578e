/* SPDX-License-Identifier: Apache-2.0 */
/* Triangle sheets (Karaoz 2015, chapter 2.1): vertices are particles of the world, edges are sides of
 * triangles. What tears and cuts make comes from the spare particles and triangles, lowest number
 * first; nothing is ever given back.
 *
 *   rest coordinates   u along weft, v along warp, Q24 lu; triangles are anticlockwise in them
 *   side k             of a triangle: the one opposite its corner k, from corner k + 1 to corner k + 2
 *   fan                of a vertex: its triangles, anticlockwise; closed, or open at a border.
 *                      A vertex has one fan, of at most SHEET_FAN triangles.
 *   area               Q30 lu^2, below SHEET_AREA_MAX. A triangle's area is divided, never computed
 *                      again, so the sum over a sheet stays the same to the last bit
 *   mass               of a vertex: sum of the areas of its fan; a third of that, times the cloth's
 *                      density, is its mass. The sum over all vertices is three times the area.
 *
 * Momentum is the sum of mass times velocity, and `owed`: what rounding the velocity of a vertex that
 * was born on a side or in a triangle left over, which the next one gets. It stays the same to the last
 * bit in every operation here. */
#ifndef FRAY_MODEL_SHEET_H
#define FRAY_MODEL_SHEET_H

#include "rt/base/fx.h"
#include "rt/fray.h"
#include "rt/model/params.h"
#include "rt/model/rows.h"
#include "rt/model/toughness.h"

enum { SHEET_FAN = 16, LIMIT_TRIANGLES = 1 << 20, LIMIT_CLOTHS = 8 };
#define SHEET_NONE UINT32_MAX
#define SHEET_AREA_MAX (1u << 27)

/* `across` names the triangle beyond side k, or the triangle itself where there is none: sheet_across(). */
typedef struct {
  row_id v[3];
  row_id across[3];
} sheet_triangle;

/* Weights of the corners 1 and 2 in the vectors U and V (2.13 to 2.27), Q22 of 1/lu; those of corner 0
 * are what makes the sums zero (2.15). */
enum { SHEET_WEIGHT_BITS = 22 };
typedef struct {
  int32_t u1, u2, v1, v2;
} sheet_weights;

/* What made a border of a side; two bits a side in `mark`. */
typedef enum { SHEET_WHOLE = 0, SHEET_TORN = 1, SHEET_CUT = 2 } sheet_mark;
/* And one of the triangle: it is beside a cut, and the blade that made it may still be in it. */
enum { SHEET_PARTED = 64, SHEET_MARKS = 63 };

/*    name              least       most */
#define SHEET_PARAMS(X) \
  X(triangles,          1,          LIMIT_TRIANGLES) /* at tick 0; the others are spare ones */ \
  X(cloths,             1,          LIMIT_CLOTHS) \
  X(area_min,           1 << 8,     1 << 27)    /* Q30 lu^2: no tear or cut leaves less ... */ \
  X(height_min,         1 << 15,    1 << 24)    /* Q24 lu: ... or a lower triangle */
typedef struct {
#define X(name, least, most) int32_t name;
  SHEET_PARAMS(X)
#undef X
} sheet_params;

/*    name              least       most */
#define SHEET_STATE(X) \
  X(triangles,          1,          LIMIT_TRIANGLES) /* in use */ \
  X(born,               0,          LIMIT_PARTICLES) /* spare particles in use */ \
  X(owed_x,             -(1 << 30), 1 << 30)         /* momentum, see above */ \
  X(owed_y,             -(1 << 30), 1 << 30) \
  X(owed_z,             -(1 << 30), 1 << 30) \
  X(resting_0,          0,          LIMIT_RELAX)     /* ticks until that cloth may tear again */ \
  X(resting_1,          0,          LIMIT_RELAX) \
  X(resting_2,          0,          LIMIT_RELAX) \
  X(resting_3,          0,          LIMIT_RELAX) \
  X(resting_4,          0,          LIMIT_RELAX) \
  X(resting_5,          0,          LIMIT_RELAX) \
  X(resting_6,          0,          LIMIT_RELAX) \
  X(resting_7,          0,          LIMIT_RELAX)
typedef struct {
  int32_t triangles, born;
  int32_t owed[3];
  int32_t resting[LIMIT_CLOTHS];
} sheet_state;

typedef struct {
  /* constants */
  const sheet_params *params;

  /* state */
  sheet_state *state;
  sheet_triangle *triangle;
  uint32_t *area;   /* of a triangle */
  uint8_t *mark;    /* of a triangle */
  uint8_t *cloth;   /* of a triangle */
  int32_t *u, *v;   /* of a particle */
  row_id *fan;      /* of a particle: the first triangle of an open fan, any of a closed one */

  /* follows from them; sheet_derive() */
  uint32_t *mass;         /* of a particle; 0 of those that no triangle has */
  sheet_weights *weights; /* of a triangle */
} sheet_mesh;

enum {
  SHEET_TRIANGLE_IDS = 6,
  SHEET_PARAM_WORDS = sizeof(sheet_params) / 4,
  SHEET_STATE_WORDS = sizeof(sheet_state) / 4
};

static inline uint32_t sheet_next(uint32_t k) { return k == 2 ? 0 : k + 1u; }
static inline uint32_t sheet_last(uint32_t k) { return k == 0 ? 2 : k - 1u; }

static inline uint32_t sheet_across(const sheet_mesh *s, uint32_t t, uint32_t k) {
  const uint32_t across = s->triangle[t].across[k];
  return across == t ? SHEET_NONE : across;
}
/* Which corner of the triangle the vertex is; 3: none. */
static inline uint32_t sheet_corner(const sheet_mesh *s, uint32_t t, uint32_t vertex) {
  const sheet_triangle *f = &s->triangle[t];
  return f->v[0] == vertex ? 0 : f->v[1] == vertex ? 1 : f->v[2] == vertex ? 2 : 3;
}
/* Which side of the triangle across it side k of t is. */
static inline uint32_t sheet_back(const sheet_mesh *s, uint32_t t, uint32_t k) {
  return sheet_next(sheet_corner(s, s->triangle[t].across[k], s->triangle[t].v[sheet_next(k)]));
}
static inline sheet_mark sheet_mark_of(const sheet_mesh *s, uint32_t t, uint32_t k) {
  return (sheet_mark)((uint32_t)s->mark[t] >> (2u * k) & 3u);
}

static inline int sheet_is_parted(const sheet_mesh *s, uint32_t t) {
  return ((uint32_t)s->mark[t] & SHEET_PARTED) != 0;
}

/* The triangles around a vertex, anticlockwise, and which corner of each it is. The spoke between
 * triangle n - 1 and n goes to corner + 1 of triangle n. */
typedef struct {
  uint32_t count;
  uint32_t closed;
  uint32_t triangle[SHEET_FAN];
  uint8_t corner[SHEET_FAN];
} sheet_fan;

/* Cost: linear in the fan; never more than SHEET_FAN. */
void sheet_walk(const sheet_mesh *s, uint32_t vertex, sheet_fan *fan);
static inline int sheet_is_open(const sheet_mesh *s, uint32_t vertex) {
  const uint32_t t = s->fan[vertex];
  return sheet_across(s, t, sheet_last(sheet_corner(s, t, vertex))) == SHEET_NONE;
}

typedef struct {
  int32_t u, v; /* Q24 lu, within 32 lu */
} sheet_point;
static inline sheet_point sheet_at(const sheet_mesh *s, uint32_t vertex) {
  const sheet_point p = {s->u[vertex], s->v[vertex]};
  return p;
}
/* Twice the area of a triangle, negative where it is clockwise; Q48 lu^2, exact. */
int64_t sheet_twice_area(sheet_point a, sheet_point b, sheet_point c);
/* Area is at least 4^by times, the least height 2^by times what a sheet may have; by is at most 1. */
int sheet_is_stouter(const sheet_mesh *s, uint32_t by, sheet_point a, sheet_point b, sheet_point c);
static inline int sheet_is_stout(const sheet_mesh *s, sheet_point a, sheet_point b, sheet_point c) {
  return sheet_is_stouter(s, 0, a, b, c);
}
/* Of a triangle with at least the least area and height. */
sheet_weights sheet_weights_of(const sheet_mesh *s, uint32_t t);

/* Fills what follows from the state. Cost: linear in particles and triangles. */
void sheet_derive(fray_world *w);

/* The topology's hash has an entry for every triangle and every vertex in use: XOR of them all. The
 * operations keep it up to date. */
uint64_t sheet_triangle_entry(const sheet_mesh *s, uint32_t t);
uint64_t sheet_vertex_entry(const sheet_mesh *s, uint32_t p);
uint64_t sheet_topology(const fray_world *w);

#endif
