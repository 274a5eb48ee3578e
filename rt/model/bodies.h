/* SPDX-License-Identifier: Apache-2.0 */
/* Rigid bodies: constants, path keys and state, all tables of 32-bit words.
 * Bodies translate; their orientation is fixed when the scene is compiled. */
#ifndef FRAY_MODEL_BODIES_H
#define FRAY_MODEL_BODIES_H

#include <stdint.h>

#include "rt/base/vec.h"
#include "rt/fray.h"

typedef struct {
  int32_t shape;       /* fray_shape */
  int32_t motion;      /* fray_motion */
  int32_t hand;        /* which hand moves it, FRAY_HAND only */
  int32_t radius;      /* Q24 lu */
  int32_t half[3];     /* Q24 lu */
  int32_t axes[9];     /* Q30, row n is the body's axis n in the world */
  int32_t reach[3];    /* Q24 lu: half sizes of the box around it, along the world's axes */
  int32_t friction;    /* Q16 */
  int32_t yield;       /* particle mass over body mass, Q30; 0 unless FRAY_FREE */
  int32_t key_first;   /* FRAY_PATH: keys [key_first, key_first + keys) */
  int32_t keys;
  int32_t home[3];     /* Q24 lu: where it stands at tick 0 */
} body;

/* Has a surface that is computed from its sizes. */
static inline int body_is_solid(const body *k) {
  return k->shape != FRAY_ANCHOR && k->shape != FRAY_MESH;
}

/* A path goes straight from key to key and rests after the last. */
typedef struct {
  int32_t tick;
  int32_t position[3]; /* Q24 lu */
} body_key;

typedef struct {
  int32_t position[3];  /* Q24 lu */
  int32_t remainder[3]; /* Q28, -8..8, as for particles */
  int32_t velocity[3];  /* Q28 lu per substep */
  int32_t fraction[3];  /* unsigned, 2^-30 of a velocity step: what yield left over */
} body_state;

enum {
  BODY_WORDS = sizeof(body) / 4,
  BODY_KEY_WORDS = sizeof(body_key) / 4,
  BODY_STATE_WORDS = sizeof(body_state) / 4
};

/* Of one tick or substep, not part of the state. */
typedef struct {
  vec3 from;          /* position at the start of the tick */
  vec3 to;            /* where a driven body goes in this tick */
  vec3 moved;         /* in this substep, Q24 lu */
  int64_t impulse[3]; /* what the cloth gained from it in this tick: Q28 lu per substep */
  int64_t settled[3]; /* the part of impulse that has already moved a free body */
} body_motion;

static inline void body_gave(body_motion *m, int64_t x, int64_t y, int64_t z) {
  m->impulse[0] = fx_add64(m->impulse[0], x);
  m->impulse[1] = fx_add64(m->impulse[1], y);
  m->impulse[2] = fx_add64(m->impulse[2], z);
}

#endif
