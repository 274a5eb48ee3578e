/* SPDX-License-Identifier: Apache-2.0 */
/* The trimesh, mesh of the membrane (Karaoz 2015, chapter 2.1): vertices are particles of the world, edges
 * belong to triangles. New vertices and triangles are taken from the spare pools in ascending order and never
 * freed.
 *
 *   rest coordinates   u along weft, v along warp, Q24 lu; triangles are anticlockwise in them
 *   edge k             of a triangle: the one opposite its corner k, from corner k + 1 to corner k + 2
 *   one-ring           of a vertex: its triangles, anticlockwise; closed, or open on the boundary.
 *                      A vertex has one ring, of at most TRIMESH_RING_MAX triangles.
 *   area               Q30 lu^2, below TRIMESH_AREA_MAX. A triangle's area is divided, never computed
 *                      again, so the sum over a mesh stays the same to the last bit
 *   mass               of a vertex: sum of the areas of its ring; a third of that, times the material's
 *                      density, is its mass. The sum over all vertices is three times the area.
 *
 * Momentum is the sum of mass times velocity, plus `momentum_remainder`: what rounding the velocity of a new
 * vertex on an edge or in a triangle left, which the next one gets. It stays the same to the last bit in
 * every operation of trimesh/. */
#ifndef FRAY_STATE_TRIMESH_H
#define FRAY_STATE_TRIMESH_H

#include "rt/base/fx.h"
#include "rt/fray.h"
#include "rt/state/bend_plate.h"
#include "rt/state/params.h"
#include "rt/state/spring.h"
#include "rt/state/tear_strength.h"

enum { TRIMESH_RING_MAX = 16, MAX_TRIANGLES = 1 << 20, MAX_MATERIALS = 8 };
#define TRIMESH_NONE UINT32_MAX
#define TRIMESH_AREA_MAX (1u << 27)

/* neighbour[k] is the triangle beyond edge k, or the triangle itself where there is none:
 * trimesh_neighbour(). */
typedef struct {
  index_t v[3];
  index_t neighbour[3];
} trimesh_triangle;

/* Weights of the corners 1 and 2 in the vectors U and V (2.13 to 2.27), Q22 of 1/lu; those of corner 0
 * make the sums zero (2.15). */
enum { TRIMESH_WEIGHT_BITS = 22 };
typedef struct {
  int32_t u1, u2, v1, v2;
} trimesh_weights;

/* The sum of r r' over the weights r = (u, v) of the three corners, Q12 of 1/lu^2, rounded down. */
typedef struct {
  uint32_t uu, vv;
  int32_t uv;
} trimesh_gram;
static inline trimesh_gram trimesh_gram_of(const trimesh_weights *r) {
  const int32_t u0 = fx_add(r->u1, r->u2);
  const int32_t v0 = fx_add(r->v1, r->v2);
  const uint64_t uu = fx_square(r->u1) + fx_square(r->u2) + fx_square(u0);
  const uint64_t vv = fx_square(r->v1) + fx_square(r->v2) + fx_square(v0);
  const int64_t uv =
      fx_add64(fx_add64(fx_mul_wide(r->u1, r->v1), fx_mul_wide(r->u2, r->v2)), fx_mul_wide(u0, v0));
  const trimesh_gram g = {(uint32_t)(uu >> 32), (uint32_t)(vv >> 32), (int32_t)fx_asr64(uv, 32)};
  return g;
}
/* Whether its greater eigenvalue is at most this. */
static inline int trimesh_gram_is_within(const trimesh_gram *g, uint32_t max) {
  return g->uu <= max && g->vv <= max && fx_mul_wide_u(max - g->uu, max - g->vv) >= fx_square(g->uv);
}
/* That eigenvalue, Q12: the square of the largest deformation gradient of corners that move by 1, all squares
 * added. A triangle alone, with the stiffness s of its stiffest mode, vibrates at no more than
 * root(3 s norm2 / density). */
static inline uint32_t trimesh_norm2(const trimesh_gram *g) {
  const uint32_t apart = g->uu > g->vv ? g->uu - g->vv : g->vv - g->uu;
  const uint64_t squared = fx_mul_wide_u(apart, apart) + 4u * fx_square(g->uv);
  const uint32_t root = squared == 0 ? 0 : fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
  return (uint32_t)(((uint64_t)g->uu + g->vv + root) >> 1);
}

/* What made a boundary of an edge; two bits an edge in `edge_marks`. */
typedef enum { TRIMESH_WHOLE = 0, TRIMESH_TORN = 1, TRIMESH_CUT = 2 } trimesh_mark;
/* And one of the triangle: it is next to a cut, and the blade that made it may still be in it. */
enum { TRIMESH_PASSING_BLADE = 64, TRIMESH_MARKS = 63 };

/*    name              min         max */
#define TRIMESH_PARAMS(X) \
  X(triangles,          1,          MAX_TRIANGLES) /* at tick 0; the others are spare */ \
  X(materials,          1,          MAX_MATERIALS) \
  X(area_min,           1 << 8,     1 << 27)    /* Q30 lu^2: no tear or cut leaves less ... */ \
  X(height_min,         1 << 15,    1 << 24)    /* Q24 lu: ... or a lower triangle */
typedef struct {
#define X(name, min, max) int32_t name;
  TRIMESH_PARAMS(X)
#undef X
} trimesh_params;

/*    name              min         max */
#define TRIMESH_STATE(X) \
  X(triangles,          1,          MAX_TRIANGLES) /* in use */ \
  X(allocated,          0,          MAX_PARTICLES) /* spare particles in use */ \
  X(momentum_remainder_x, -WORD_MAX, WORD_MAX) /* see above */ \
  X(momentum_remainder_y, -WORD_MAX, WORD_MAX) \
  X(momentum_remainder_z, -WORD_MAX, WORD_MAX) \
  X(contact_tank_high,  0,          WORD_MAX) /* elastic/step_passive.h */ \
  X(contact_tank_low,   0,          WORD_MAX) \
  X(tear_cooldown_0,    0,          MAX_TEAR_COOLDOWN)     /* ticks until that material may tear again */ \
  X(tear_cooldown_1,    0,          MAX_TEAR_COOLDOWN) \
  X(tear_cooldown_2,    0,          MAX_TEAR_COOLDOWN) \
  X(tear_cooldown_3,    0,          MAX_TEAR_COOLDOWN) \
  X(tear_cooldown_4,    0,          MAX_TEAR_COOLDOWN) \
  X(tear_cooldown_5,    0,          MAX_TEAR_COOLDOWN) \
  X(tear_cooldown_6,    0,          MAX_TEAR_COOLDOWN) \
  X(tear_cooldown_7,    0,          MAX_TEAR_COOLDOWN)
typedef struct {
  int32_t triangles, allocated;
  int32_t momentum_remainder[3];
  int32_t contact_tank[2];
  int32_t tear_cooldown[MAX_MATERIALS];
} trimesh_state;

typedef struct {
  /* constants */
  const trimesh_params *params;

  /* state */
  trimesh_state *state;
  trimesh_triangle *triangle;
  uint32_t *area;          /* of a triangle */
  uint8_t *edge_marks;     /* of a triangle */
  uint8_t *material;       /* of a triangle */
  int32_t *u, *v;          /* of a vertex */
  index_t *first_triangle; /* of a vertex: the first triangle of an open ring, any of a closed one */

  /* follows from them; trimesh_derive() */
  uint32_t *mass;           /* of a vertex; 0: no triangle has it */
  trimesh_weights *weights; /* of a triangle */
} trimesh;

enum {
  TRIMESH_TRIANGLE_IDS = 6,
  TRIMESH_PARAM_WORDS = sizeof(trimesh_params) / 4,
  TRIMESH_STATE_WORDS = sizeof(trimesh_state) / 4
};

static inline uint32_t trimesh_next(uint32_t k) { return k == 2 ? 0 : k + 1u; }
static inline uint32_t trimesh_previous(uint32_t k) { return k == 0 ? 2 : k - 1u; }

static inline uint32_t trimesh_neighbour(const trimesh *s, uint32_t t, uint32_t k) {
  FRAY_ASSERT(k < 3);
  const uint32_t neighbour = s->triangle[t].neighbour[k];
  return neighbour == t ? TRIMESH_NONE : neighbour;
}
/* The corner of the triangle that is this vertex; 3: none. */
static inline uint32_t trimesh_corner(const trimesh *s, uint32_t t, uint32_t vertex) {
  const trimesh_triangle *f = &s->triangle[t];
  return f->v[0] == vertex ? 0 : f->v[1] == vertex ? 1 : f->v[2] == vertex ? 2 : 3;
}
/* The edge of its neighbour that edge k of t is. */
static inline uint32_t trimesh_neighbour_edge(const trimesh *s, uint32_t t, uint32_t k) {
  return trimesh_next(trimesh_corner(s, s->triangle[t].neighbour[k], s->triangle[t].v[trimesh_next(k)]));
}
static inline trimesh_mark trimesh_mark_of(const trimesh *s, uint32_t t, uint32_t k) {
  FRAY_ASSERT(k < 3);
  return (trimesh_mark)((uint32_t)s->edge_marks[t] >> (2u * k) & 3u);
}

static inline int trimesh_is_passing_blade(const trimesh *s, uint32_t t) {
  return ((uint32_t)s->edge_marks[t] & TRIMESH_PASSING_BLADE) != 0;
}

/* The triangles around a vertex, anticlockwise, and which corner of each it is. Ring edge n, between
 * triangles n - 1 and n, goes to corner + 1 of triangle n. */
typedef struct {
  uint32_t count;
  uint32_t closed;
  uint32_t triangle[TRIMESH_RING_MAX];
  uint8_t corner[TRIMESH_RING_MAX];
} trimesh_ring;

/* Cost: linear in the ring; never more than TRIMESH_RING_MAX. */
void trimesh_ring_of(const trimesh *s, uint32_t vertex, trimesh_ring *ring);
static inline int trimesh_is_boundary(const trimesh *s, uint32_t vertex) {
  const uint32_t t = s->first_triangle[vertex];
  return trimesh_neighbour(s, t, trimesh_previous(trimesh_corner(s, t, vertex))) == TRIMESH_NONE;
}

typedef struct {
  int32_t u, v; /* Q24 lu, within 32 lu */
} trimesh_point;
static inline trimesh_point trimesh_at(const trimesh *s, uint32_t vertex) {
  const trimesh_point p = {s->u[vertex], s->v[vertex]};
  return p;
}
/* Twice the area of a triangle, negative where it is clockwise; Q48 lu^2, exact. */
int64_t trimesh_twice_area(trimesh_point a, trimesh_point b, trimesh_point c);
/* 1 iff area is at least 4^by times, the smallest height 2^by times the minimum of params; by is at most 1.
 * */
int trimesh_exceeds_quality(const trimesh *s, uint32_t by, trimesh_point a, trimesh_point b, trimesh_point c);
static inline int trimesh_has_quality(const trimesh *s, trimesh_point a, trimesh_point b, trimesh_point c) {
  return trimesh_exceeds_quality(s, 0, a, b, c);
}
/* Of a triangle with at least the minimal area and height. */
trimesh_weights trimesh_weights_between(trimesh_point a, trimesh_point b, trimesh_point c);
static inline trimesh_weights trimesh_weights_of(const trimesh *s, uint32_t t) {
  const index_t *v = s->triangle[t].v;
  return trimesh_weights_between(trimesh_at(s, v[0]), trimesh_at(s, v[1]), trimesh_at(s, v[2]));
}
bend_shape bend_shape_of(const trimesh *s, uint32_t t);

/* Computes mass, weights and shapes for bending from the state. Cost: linear in particles and triangles. */
void trimesh_derive(fray_world *w);

/* The topology's hash has an entry for every triangle and every vertex in use: XOR of them all. The
 * operations keep it up to date. */
uint64_t trimesh_triangle_entry(const trimesh *s, uint32_t t);
uint64_t trimesh_vertex_entry(const trimesh *s, uint32_t p);
uint64_t trimesh_topology(const fray_world *w);

#endif
