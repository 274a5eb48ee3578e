/* SPDX-License-Identifier: Apache-2.0 */
/* Self-collision (Metaaphanon 2009, section 4.2; Karaoz 2015, section 2.6): parameters and impact zones
 * of both models, and what the self-collision of yarns works with in a tick. A segment of a yarn is a
 * structural link that is not broken. */
#ifndef FRAY_STATE_SELF_PAIRS_H
#define FRAY_STATE_SELF_PAIRS_H

#include "rt/base/vec.h"
#include "rt/state/params.h"
#include "rt/state/spring.h"

/* Of worlds with self-collision only.
 *    name              min         max */
#define SELF_PARAMS(X) \
  X(thickness,          1,          SELF_THICKNESS_MAX) /* Q24 lu: the distance that is kept */ \
  X(slack,              1,          1 << 22)   /* Q24 lu along an axis: how far a pass may move a particle \
                                                  from its path's end before pairs are searched again */

typedef struct {
#define X(name, min, max) int32_t name;
  SELF_PARAMS(X)
#undef X
} self_params;

enum {
#define X(name, min, max) +1
  SELF_PARAM_WORDS = 0 SELF_PARAMS(X),
#undef X
  MAX_YARN_PAIRS = 1 << 20,
  SELF_THICKNESS_MAX = 1 << 22,
  SELF_PASSES = 8,   /* searches of the whole cloth in a tick */
  SELF_FOLLOWS = 4,  /* of these, behind which links follow zones of yarns */
  SELF_ROUNDS = 3,   /* rounds of pushes */
  SELF_MERGES = 8,   /* rounds of merges in a pass */
  SELF_VISITS = 128, /* tests of two boxes in a pass, for each crossing */
  SELF_WITHOUT_ROOM = 192,         /* pairs without room in a tick that are tested, for each crossing, */
  SELF_TRIANGLES_WITHOUT_ROOM = 64, /* for each triangle */
  SELF_BOXES = 2,    /* nodes of the tree for each crossing: 4/3, and what odd sizes add */
  SELF_LEVELS = 13
};

/* Sweeps of links that follow a zone: it goes back by the way of a tick. */
static inline uint32_t self_follow_sweeps(uint32_t substeps) { return (substeps + 7u) / 8u; }

/* A particle's straight path in the tick, Q24 lu. */
typedef vec_path self_path;

/* The same along the cloth's own axes. */
typedef vec_path self_grid_path;

/* A box at the start of the tick [0] and one at its end [1]. */
typedef struct {
  vec3 low[2], high[2];
} self_box;

/* Two segments that may collide in this tick. Rounds count from 1. */
typedef struct {
  index_t a, b;         /* springs */
  uint8_t tested_round; /* the round of their last test */
  uint8_t near;         /* that test found them near each other */
} self_pair;

/* An impact zone: particles that move as one. */
typedef struct {
  int64_t sum[3];  /* mass times path, mass times Q24 lu; then momentum */
  int64_t whole;   /* of vertices: the sum of their masses */
  int32_t mean[3]; /* mean velocity, Q28 lu per substep */
  int32_t half[3]; /* in an elastic step: half of what its forces change of that */
  uint32_t inverse_mass; /* there: Q24 of 1 / particle mass */
  int32_t mass;    /* half crossings; of vertices 64ths of a particle */
  uint32_t members;
  uint32_t held;   /* an attached or pinned member; then the heaviest one; or SELF_NONE */
} self_zone;
#define SELF_NONE UINT32_MAX

#endif
