/* SPDX-License-Identifier: Apache-2.0 */
/* Self-collision of a woven sheet's yarns (Metaaphanon 2009, section 4.2): constants, and what a tick
 * works with. A segment is a living structural link, named by its canonical number. */
#ifndef FRAY_MODEL_SELVES_H
#define FRAY_MODEL_SELVES_H

#include "rt/base/vec.h"
#include "rt/model/params.h"
#include "rt/model/rows.h"

/* Of worlds with self-collision only.
 *    name              least       most */
#define SELVES_PARAMS(X) \
  X(thickness,          1,          SELVES_THICKNESS_MAX) /* Q24 lu: yarns are kept this far apart */ \
  X(slack,              1,          1 << 22)   /* Q24 lu: how far an end may be put along an axis before \
                                                  all is looked at again */

typedef struct {
#define X(name, least, most) int32_t name;
  SELVES_PARAMS(X)
#undef X
} selves_params;

enum {
#define X(name, least, most) +1
  SELVES_PARAM_WORDS = 0 SELVES_PARAMS(X),
#undef X
  LIMIT_PAIRS = 1 << 20,
  SELVES_THICKNESS_MAX = 1 << 22,
  SELVES_PASSES = 8,  /* looks at the whole sheet in a tick */
  SELVES_ROUNDS = 3,  /* of pushes */
  SELVES_MERGES = 8,  /* rounds in which what still meets is joined, in each pass */
  SELVES_VISITS = 128, /* boxes held against each other in a pass, a crossing */
  SELVES_BOXES = 2,   /* of the tree, a crossing: 4/3 and what sides of odd length take */
  SELVES_LEVELS = 13
};

/* A particle's way through the tick: where it began, where it would end. */
typedef struct {
  vec3 begin, end; /* Q24 lu */
} self_way;

/* The same along the sheet's own axes, Q24 lu. */
typedef struct {
  int32_t begin[3], end[3];
} self_field;

/* Around what is where at the tick's begin, and at its end. */
typedef struct {
  int32_t low[2][3], high[2][3];
} self_box;

/* Segments that may meet in this tick. Rounds of it count from 1. */
typedef struct {
  row_id a, b;    /* rows */
  uint8_t looked; /* the round in which they were held against each other last */
  uint8_t near;   /* they came near each other then */
} self_pair;

/* Particles that move as one. */
typedef struct {
  int64_t sum[3]; /* of mass times way, mass times Q24 lu */
  int64_t whole;  /* of vertices: their masses */
  int32_t mean[3]; /* speed of them, Q28 lu per substep */
  int32_t mass;   /* half crossings; of vertices 64ths of a particle */
  uint32_t members, held; /* held: a particle of a body among them, or SELF_NOBODY */
} self_zone;
#define SELF_NOBODY UINT32_MAX

#endif
