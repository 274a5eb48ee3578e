/* SPDX-License-Identifier: Apache-2.0 */
/* Self-collision of the membrane (Karaoz 2015, section 2.6): the cached list of near pairs, and what a
 * tick works with. Its parameters are those of self_pairs.h; self_collision/triangle_collision_find.c
 * says how the list works. */
#ifndef FRAY_STATE_TRIANGLE_PAIRS_H
#define FRAY_STATE_TRIANGLE_PAIRS_H

#include "rt/state/self_pairs.h"

enum {
  MAX_TRIANGLE_PAIRS = 1 << 22,
  TRIANGLE_PAIR_CORNERS = 6, /* kinds of vertex-triangle pairs; kinds from here on are pairs of edges */
  TRIANGLE_PAIR_CHECKS = SELF_PASSES + 2, /* tests against bodies in a tick: one after each pass */
  PATCHES_ACROSS = 8,        /* patches along weft and warp at most */
  PATCHES_MAX = PATCHES_ACROSS * PATCHES_ACROSS,
  PATCH_TRIANGLES = 32,      /* triangles of a patch, about, at least */
  PATCH_PARTS = 3,           /* parts of a patch along weft and warp; triangles are sorted by part */
  BOX_CLUSTER = 8            /* triangles of a cluster: neighbours in that order, with one box */
};
#define TRIANGLE_PAIR_STALE INT32_MAX

/* A vertex p[0] and a triangle p[1..3], or two edges p[0..1] and p[2..3], of two triangles of the
 * membrane; the triangle with the greater number first. */
typedef struct {
  int32_t recheck_at;     /* travel of both triangles and their patches, since they were listed, below which
                             the two cannot collide */
  index_t triangle[2];
  index_t p[4];
  uint8_t kind;           /* 0..2: a vertex of the first triangle, 3..5: of the second; above that
                             TRIANGLE_PAIR_CORNERS + 3 m + n: edge m of the first and n of the second */
  uint8_t was_one_vertex; /* a tear made two of its vertices from one */
  uint8_t tested_round;   /* as in self_pair */
  uint8_t near;
} triangle_pair;

/* How many of a pair's particles belong to its first part: 1 of a vertex, 2 of an edge. */
static inline uint32_t triangle_pair_firsts(const triangle_pair *of) {
  return of->kind < TRIANGLE_PAIR_CORNERS ? 1u : 2u;
}

/* A triangle's box at the start of the tick, widened by its travel budget. */
typedef struct {
  vec3 low, high;
  index_t v[3];        /* when it was listed */
  uint8_t owned;       /* bits 0..2: vertices, 3..5: edges that are tested with this triangle and no other */
  uint8_t patch, part;
  uint8_t fast;        /* it moves so fast that its pairs are listed for this tick alone */
} triangle_box;

typedef struct {
  vec3 low, high;
} box_cluster;

/* Travel of a triangle since it was listed: that of its farthest corner, relative to the mean of its
 * patch. Q24 lu. */
typedef struct {
  vec3 from[3];
  int32_t travelled; /* up to the start of the tick */
  int32_t budget;    /* every possible pair is listed until it has travelled that far; negative: not listed */
  int32_t allowance; /* how far from where the tick began the pairs that this search finds hold */
} triangle_travel;

/* Triangles near each other at rest, and the mean path of their corners. */
typedef struct {
  vec3 low, high;
  vec3 mean, travelled; /* in this tick; in all ticks before, summed */
  uint32_t first, end;  /* its triangles in triangle_collision_state.order */
  uint64_t neighbours;  /* patches with which its pairs are listed, a bit each */
} triangle_patch;

/* Two patches, the one with the greater number first: how far one has moved relative to the other since
 * their pairs were listed; as of triangles. */
typedef struct {
  vec3 from;
  int32_t travelled, budget, allowance; /* negative: too far apart for pairs */
  int32_t predicted_travel; /* including this tick; TRIANGLE_PAIR_STALE */
} patch_pair;

/* Patches along weft, and as many along warp, of so many triangles. */
static inline uint32_t patches_across(uint32_t triangles) {
  uint32_t across = 1;
  while (across < PATCHES_ACROSS && across * across * PATCH_TRIANGLES < triangles) ++across;
  return across;
}

/* The list of pairs. */
typedef struct {
  uint32_t valid;        /* pairs of earlier ticks can be used */
  uint32_t pairs, active, stale;
  uint32_t lasting;      /* pairs before these hold beyond the search that found them */
  uint32_t out_of_range; /* some travel of this tick exceeds what the list can represent */
  uint32_t particles, triangles; /* in use when it was filled */
  uint64_t topology;
  int32_t default_budget; /* of triangles that are not fast */
  uint32_t across;        /* patches along weft and warp */
  int32_t low[2], size[2]; /* at rest: where the patches begin, how wide a part is */
  uint32_t this_search_only; /* what is listed is for this search alone */
  uint32_t pool_short;     /* the pool of pairs is full */
  uint32_t merge_rest;     /* pairs that have no room are merged where they touch, instead of listed */
  uint32_t without_room;   /* how many of them were tested in this attempt at the tick */
  uint32_t merged_without_room; /* in this pass, so others may touch by that */
} triangle_pair_list;

/* Two features that may meet in this tick, for its elastic steps. */
typedef struct {
  index_t p[4];
  int32_t weight[4]; /* Q15, those of the first feature negative, sum 0 */
  vec3 normal;       /* Q30, from the first to the second */
  int32_t gap, low;  /* beyond the thickness: Q28 lu, and 31 bits below it */
  int32_t gap_begin; /* when the tick begins */
  int32_t mass;      /* effective mass, Q16 of a particle's mass */
} self_constraint;
enum { SELF_CONSTRAINTS = 1 }; /* room for each vertex */

#endif
