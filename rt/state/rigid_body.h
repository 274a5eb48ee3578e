/* SPDX-License-Identifier: Apache-2.0 */
/* Rigid bodies: constants, path keys and state, all tables of 32-bit words.
 * Bodies translate; their orientation is fixed when the scene is compiled. */
#ifndef FRAY_STATE_RIGID_BODY_H
#define FRAY_STATE_RIGID_BODY_H

#include <stdint.h>

#include "rt/base/vec.h"
#include "rt/fray.h"

typedef struct {
  int32_t shape;       /* fray_shape, in its range */
  int32_t motion;      /* fray_motion */
  int32_t hand;        /* which hand moves it, FRAY_HAND only */
  int32_t radius;      /* Q24 lu */
  int32_t half[3];     /* Q24 lu */
  int32_t axes[9];     /* Q30, row n is the body's axis n in the world */
  int32_t aabb_half[3];    /* Q24 lu: half sizes of the box around it, along the world's axes */
  int32_t friction;    /* Q16 */
  int32_t mass_ratio;       /* particle mass over body mass, Q30; 0 unless FRAY_FREE */
  int32_t keyframe_first;   /* FRAY_PATH: keys [keyframe_first, keyframe_first + keyframes) */
  int32_t keyframes;
  int32_t start[3];     /* Q24 lu: position at tick 0 */
} rigid_body;

/* Every shape but the anchor, in the order of fray_shape. rt/ADDING.md says what else a new one needs.
 *    word       its name in scenes and in `fray info`
 *    radius     1: it has a radius
 *    halves     how many of half[] it has, 0 to 3; a shape lies within the box of its half sizes, the
 *               others 0, grown by its radius
 *    primitive  1: cloth meets a surface that contact/shape.h computes from those sizes
 *    collider   1: its centre, grown by its radius, is tested by CCD against triangles of the membrane, as
 *               meshes are in any case */
#define SHAPES(X) \
  /* name     word       radius  halves  primitive  collider */ \
  X(SPHERE,   "sphere",  1,      0,      1,         1) \
  X(BOX,      "box",     0,      3,      1,         0) \
  X(CAPSULE,  "capsule", 1,      1,      1,         0) \
  X(PLANE,    "plane",   0,      0,      1,         0) \
  X(MESH,     "mesh",    0,      0,      0,         0)

enum {
#define X(name, word, radius, halves, primitive, collider) +1
  SHAPES_END = FRAY_ANCHOR + 1 SHAPES(X),
#undef X
#define X(name, word, radius, halves, primitive, collider) +(primitive) * (1 << FRAY_##name)
  SHAPES_PRIMITIVE = 0 SHAPES(X),
#undef X
#define X(name, word, radius, halves, primitive, collider) +(collider) * (1 << FRAY_##name)
  SHAPES_COLLIDER = 0 SHAPES(X)
#undef X
};

static inline int body_is_primitive(const rigid_body *k) { return (SHAPES_PRIMITIVE >> k->shape & 1) != 0; }
static inline int body_is_sphere_collider(const rigid_body *k) {
  return (SHAPES_COLLIDER >> k->shape & 1) != 0;
}
static inline int body_is_mesh(const rigid_body *k) { return k->shape == FRAY_MESH; }
/* No impulse moves it. */
static inline int body_is_driven(const rigid_body *k) { return k->motion != FRAY_FREE || k->mass_ratio <= 0; }

/* A path goes straight from key to key and rests after the last. */
typedef struct {
  int32_t tick;
  int32_t position[3]; /* Q24 lu */
} keyframe;

typedef struct {
  int32_t position[3];  /* Q24 lu */
  int32_t remainder[3]; /* Q28, -8..8, as for particles */
  int32_t velocity[3];  /* Q28 lu per substep */
  int32_t fraction[3];  /* unsigned, 2^-30 of a velocity step: what the mass ratio left over */
} body_state;

enum {
  BODY_WORDS = sizeof(rigid_body) / 4,
  KEYFRAME_WORDS = sizeof(keyframe) / 4,
  BODY_STATE_WORDS = sizeof(body_state) / 4
};

/* Of one tick or substep, not part of the state. */
typedef struct {
  vec3 from;          /* position at the start of the tick */
  vec3 to;            /* where a driven body goes in this tick */
  vec3 moved;         /* in this substep, Q24 lu */
  int64_t impulse[3]; /* what the cloth gained from it in this tick: Q28 lu per substep */
  int64_t applied[3]; /* the part of impulse that has moved a free body already */
} body_motion;

static inline void body_add_impulse(body_motion *m, vec64 j) {
  m->impulse[0] = fx_add64(m->impulse[0], j.x);
  m->impulse[1] = fx_add64(m->impulse[1], j.y);
  m->impulse[2] = fx_add64(m->impulse[2], j.z);
}
/* The body gets the opposite of what the cloth gains. */
static inline void body_take_impulse(body_motion *m, vec3 j) {
  body_add_impulse(m, vec_sub64(vec_make(0, 0, 0), j));
}

#endif
