/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles of a sheet that meet each other (Karaoz 2015, section 2.6): what a tick works with. Constants are
 * those of self-collision (selves.h). */
#ifndef FRAY_MODEL_LAYERS_H
#define FRAY_MODEL_LAYERS_H

#include "rt/model/selves.h"

enum {
  LIMIT_LAYERS = 1 << 22,
  LAYERS_CORNERS = 6, /* kinds of pairs of a vertex and a triangle; above that two sides */
  LAYERS_LOOKS = SELVES_PASSES + 2, /* at bodies, behind each pass */
  LAYERS_ACROSS = 8,  /* tiles along weft and warp at most */
  LAYERS_TILES = LAYERS_ACROSS * LAYERS_ACROSS,
  LAYERS_TILE = 32,   /* triangles of a tile, about, at least */
  LAYERS_PARTS = 3,   /* of a tile, along weft and warp: triangles are in order by them */
  LAYERS_CLUMP = 8    /* of triangles that follow each other in order */
};

/* A vertex p[0] and a triangle, or two sides, that are near each other, and the triangles that have to look at
 * them: `of` with the greater number first. */
typedef struct {
  int32_t until;  /* how far both, and their tiles, may be from where they were listed before they can meet */
  row_id of[2];
  row_id p[4];
  uint8_t kind;   /* to LAYERS_CORNERS - 1: a vertex of the first, then of the second; then sides, 3 m + n */
  uint8_t kin;    /* a tear has made two of a vertex that both had */
  uint8_t looked; /* as of self_pair */
  uint8_t near;
} layer_pair;
static inline uint32_t layer_firsts(const layer_pair *of) { return of->kind < LAYERS_CORNERS ? 1u : 2u; }

/* A triangle where the tick began, and as much around it as it may go. */
typedef struct {
  int32_t low[3], high[3];
  row_id v[3];  /* as it was listed */
  uint8_t own;  /* bits 0 to 2: vertices that are this triangle's to look at, 3 to 5: sides */
  uint8_t tile, part;
  uint8_t hot;  /* so fast that it is not listed for longer than this tick */
} layer_box;
typedef struct {
  int32_t low[3], high[3];
} layer_clump;

/* How far a triangle is from where it was listed, by the farthest of its corners, beside what its tile has gone in
 * the mean; Q24 lu. */
typedef struct {
  vec3 from[3];
  int32_t gone; /* when the tick begins */
  int32_t room; /* all that it may meet until it has gone that far is listed; below 0: none is */
} layer_way;

/* Triangles that are near each other at rest, and what their corners go by in the mean. */
typedef struct {
  int32_t low[3], high[3];
  vec3 mean, gone;     /* in this tick; in all that went before */
  uint32_t first, end; /* of them, in layer_order */
  uint64_t near;       /* tiles that it is listed with, a bit each */
} layer_tile;

/* Two tiles, the one with the greater number first: how far one is beside the other from where it was when they
 * were listed, as of triangles. room below 0: nothing of them is listed. */
typedef struct {
  vec3 from;
  int32_t gone, room;
  int32_t soon; /* gone, and what they go in this tick; LAYERS_STALE */
} layer_beside;
/* Of so many triangles: tiles along weft, as many as along warp. */
static inline uint32_t layers_across(uint32_t triangles) {
  uint32_t across = 1;
  while (across < LAYERS_ACROSS && across * across * LAYERS_TILE < triangles) ++across;
  return across;
}
#define LAYERS_STALE INT32_MAX

/* Of the pairs that are listed. */
typedef struct {
  uint32_t kept;   /* they may be there still */
  uint32_t pairs, met, stale;
  uint32_t wild;   /* something goes farther in this tick than anything should */
  uint32_t particles, triangles; /* that were there */
  int32_t topology[2];
  int32_t usual;   /* how far a triangle may go until it is listed again, if it is not fast */
  uint32_t across; /* tiles */
  int32_t low[2], size[2]; /* at rest: where they begin, how wide one is */
  uint32_t tight, lacks, full; /* only what may meet in this tick; there is no room for one; others are joined */
} layer_list;

#endif
