/* SPDX-License-Identifier: Apache-2.0 */
/* The world: pools carved once from the caller's memory. Stages read and write it; nothing here
 * moves by itself. Which arrays are constants, which are state and which live for one tick only
 * is the table in model/image.c. */
#ifndef FRAY_MODEL_WORLD_H
#define FRAY_MODEL_WORLD_H

#include "rt/base/hash.h"
#include "rt/base/vec.h"
#include "rt/model/blades.h"
#include "rt/model/bodies.h"
#include "rt/model/cloths.h"
#include "rt/model/contacts.h"
#include "rt/model/crease.h"
#include "rt/model/inner.h"
#include "rt/model/layers.h"
#include "rt/model/params.h"
#include "rt/model/rows.h"
#include "rt/model/selves.h"
#include "rt/model/sheet.h"
#include "rt/model/stretch.h"
#include "rt/model/weave.h"

/* Pools with their capacities, in the order of the image's header. */
typedef enum {
  POOL_PARAMS,
  POOL_STATE,
  POOL_PARTICLES,
  POOL_HELD,
  POOL_CROSSINGS,
  POOL_ROWS,
  POOL_BATCHES,
  POOL_LINK_CLASSES,
  POOL_SPRING_CLASSES,
  POOL_BODIES,
  POOL_KEYS,
  POOL_CONTACTS,
  POOL_CUTS,
  POOL_SPLITS, /* a tick; not 0 iff the world has yarns */
  POOL_STRETCH, /* as many as classes of links iff its yarns have a stiffness, else 0 */
  POOL_TRIANGLES, /* not 0 iff the world is a triangle sheet and has no crossings */
  POOL_PAIRS, /* segments that may meet in a tick; not 0 iff yarns do not pass through each other */
  POOL_LAYERS, /* parts of triangles near each other; not 0 iff triangles do not pass through each other */
  POOLS_IN_HEADER,
  POOL_MESH_WORDS = POOLS_IN_HEADER, /* not 0 iff bodies are meshes; the directory says how many */
  POOL_BLADES, /* 1 iff meshes cut its triangles, else 0; the directory says it */
  POOL_TILES, /* of triangles that meet each other, and pairs of tiles: by how many triangles there are room for */
  POOL_BESIDE,
  POOLS
} pool_name;

/* A spring over its threshold, waiting to be cut. */
typedef struct {
  uint32_t row;
  uint32_t excess; /* Q16 of (length / length at threshold)^2 - 1 */
} cut;

/* Couples of one colour, (warp + 2 weft) mod 5, share no particle, not even at the far ends of their
 * springs: five crossings each, and these tile the sheet. They slip by colour, in any order. */
enum { SLIP_COLOURS = 5 };
#define SLIP_NOBODY ((row_id)~0u)

/* 1 where rt/wide has a kernel that takes couples: what it needs to know of each is kept for a tick. */
#if defined(__x86_64__) && defined(__SSE2__)
#define SLIP_PLANNED 1
#else
#define SLIP_PLANNED 0
#endif
enum { SLIP_PLAN_WORDS = 8 };

struct fray_world {
  uint32_t capacity[POOLS];
  fray_kernel kernel;
  uint32_t particles; /* in use: those of the crossings, then the split ones */

  /* constants */
  const params *params;
  const row_id *crossing;    /* crossing -> particle */
  const row_id *home;        /* row -> canonical row */
  const row_id *row_of;      /* canonical row -> row */
  const row_batch *batches;  /* of links, then bends, then shears */
  const link_class *links;   /* by class; 0 is unused */
  const spring_class *springs;
  const uint8_t *grip_body;  /* held particle -> body */
  const int32_t *grip_x, *grip_y, *grip_z; /* its place relative to the body, Q24 lu */
  const body *bodies;
  const body_key *keys;
  const yarn_params *yarns;
  const stretch_params *stretch;
  const stretch_class *pulls; /* by class of links */
  const link_class *limits;   /* links as long as they may become */
  const int32_t *meshes;     /* see model/mesh.h */
  const selves_params *selves;
  const blade_params *blades; /* of worlds whose triangles are cut */

  /* state */
  state *state;
  int32_t *x, *y, *z;        /* Q24 lu */
  int32_t *vx, *vy, *vz;     /* Q28 lu per substep */
  int8_t *rx, *ry, *rz;      /* what rounding the step to Q24 left over, Q28 */
  row_id *row_i, *row_j;
  uint8_t *row_class;
  body_state *body_states;
  yarn_state *yarn_state;
  uint8_t *couple;           /* crossing -> fray_couple, COUPLE_WANTED */
  row_id *warp_at;           /* crossing -> particle of its warp; crossing[] has that of its weft */
  row_id *place;             /* particle -> crossing */
  sheet_mesh sheet;          /* of worlds with triangles; constants and state */
  habit *habits;             /* of a triangle */
  const fabric *fabrics;     /* of them, by cloth */
  const toughness *toughnesses;
  const cloth_params *cloths;

  /* of one tick */
  int32_t *qx, *qy, *qz;     /* predicted, Q24 lu */
  body_motion *motion;
  int32_t *inverse;          /* of a vertex: 1 / mass, Q24 of 1 / particle mass */
  pull_row *pull;            /* of a triangle */
  tensor *stress;            /* of a triangle, Q12 N/m: where it was at the beginning of the tick */
  crease *creases;           /* sides of two triangles that resist folding */
  uint32_t crease_count;
  inner_place *places;       /* of a vertex */
  inner_sum *sums;           /* of a vertex, in an inner step */
  inner_sum *given;          /* that of loads */
  int32_t *low_x, *low_y, *low_z; /* of a vertex: what its place has below Q28, Q59 */
  contact *contacts;
  uint32_t contact_count;
  uint32_t gathered;         /* contacts of this tick with other bodies than meshes */
  int32_t *sx, *sy, *sz;     /* where a substep began, Q24 lu; with meshes only */
  vec3 *stood;               /* body -> where it stood then; with meshes only */
  uint8_t *aside;            /* particle -> on which sides of the box of a mesh its way stays; see stage/solids.h */
  row_id *beside;            /* triangles that come near it */
  /* of self-collision */
  self_way *ways;            /* of a particle */
  self_field *fields;        /* of a particle */
  self_box *boxes;           /* a tree over the crossings */
  uint32_t *rough;           /* crossing -> how many up to it are not spread out flat */
  self_pair *pairs;
  self_zone *zones;          /* of a particle that stands for others */
  row_id *zone_of;           /* particle -> towards the one that stands for it */
  uint8_t *stirred;          /* particle -> the round in which it was put somewhere last */
  uint32_t pair_count, began, joined; /* began: particles at the tick's begin */
  uint8_t round;
  /* of triangles that meet each other: kept as long as nothing has gone far, never state */
  layer_pair *layers;
  uint32_t *layers_met;      /* of them, those that may meet in this tick; behind them, place to order them */
  layer_way *layer_ways;     /* of a triangle */
  int32_t *layer_soon;       /* triangle -> how far it has gone, and goes in this tick; LAYERS_STALE */
  layer_box *layer_boxes;    /* of a triangle */
  row_id *layer_order;       /* triangles by tiles */
  layer_clump *layer_clumps; /* boxes around them */
  row_id *layer_stale;       /* those that are to be listed */
  uint32_t *layer_counts;    /* of a triangle: pairs that it has */
  layer_tile *tiles;
  layer_beside *tiles_beside;
  uint8_t *stands;           /* particle -> 1: put back beside a body in this tick */
  layer_list *listed;
  uint32_t sharp;            /* meshes that cut, a bit each; as long as the world */
  uint8_t *parted;           /* particle -> 1: all of its triangles are parted; see stage/slash.c */
  cut *cuts;
  uint32_t cut_count;
  uint32_t cuts_waiting;
  uint32_t cut_first;
  row_id *slip_next;         /* crossing -> the next couple of its colour that slips, or SLIP_NOBODY */
  uint32_t slip_head[SLIP_COLOURS];
#if SLIP_PLANNED
  int32_t *slip_plan;        /* SLIP_PLAN_WORDS arrays of couples that a kernel takes, by colour */
  uint32_t slip_planned[SLIP_COLOURS + 1]; /* the first of a colour */
#endif
  uint8_t acked, ack_counter, result;
  vec3 gravity_step;         /* of this substep, Q28 */
  int32_t raw_force[FRAY_HANDS][3];
  fray_work work;
};

static inline vec3 world_position(const fray_world *w, uint32_t p) {
  return vec_make(w->x[p], w->y[p], w->z[p]);
}
static inline weave world_weave(const fray_world *w) {
  const weave grid = {(uint32_t)w->params->warps, (uint32_t)w->params->wefts};
  return grid;
}

/* Batches of one kind that follow one another, from *b on: the end of their rows; *b moves behind
 * them. Rows without gaps, so that a scalar loop takes them in one go. */
static inline uint32_t world_run_of_batches(const fray_world *w, uint32_t *b, uint32_t batches) {
  const int32_t held = w->batches[*b].held;
  do ++*b;
  while (*b < batches && w->batches[*b].held == held);
  return (uint32_t)(w->batches[*b - 1u].first + w->batches[*b - 1u].count);
}

static inline int world_has_stretch(const fray_world *w) { return w->capacity[POOL_STRETCH] != 0; }
static inline int world_has_yarns(const fray_world *w) { return w->capacity[POOL_SPLITS] != 0; }

/* 0: a build that opens no triangle sheets, and has no code for them. */
#ifndef FRAY_TRIANGLES
#define FRAY_TRIANGLES 1
#endif
static inline int world_has_sheet(const fray_world *w) {
  return FRAY_TRIANGLES && w->capacity[POOL_TRIANGLES] != 0;
}

/* 0: one that opens no rigid meshes, nor sheets whose triangles meet bodies. */
#ifndef FRAY_MESHES
#define FRAY_MESHES FRAY_TRIANGLES
#endif
static inline int world_has_meshes(const fray_world *w) {
  return FRAY_MESHES && w->capacity[POOL_MESH_WORDS] != 0;
}

/* 0: one that opens no sheets with self-collision. */
#ifndef FRAY_SELVES
#define FRAY_SELVES FRAY_MESHES
#endif
static inline int world_has_selves(const fray_world *w) {
  return FRAY_SELVES && w->capacity[POOL_PAIRS] != 0;
}

/* 0: one that opens no triangle sheets that do not pass through themselves. */
#ifndef FRAY_LAYERS
#define FRAY_LAYERS (FRAY_TRIANGLES && FRAY_MESHES)
#endif
static inline int world_has_layers(const fray_world *w) {
  return FRAY_LAYERS && w->capacity[POOL_LAYERS] != 0;
}

/* Meshes cut its triangles. */
static inline int world_has_blades(const fray_world *w) {
  return FRAY_MESHES && FRAY_TRIANGLES && w->capacity[POOL_BLADES] != 0;
}

/* Enters or takes an entry out of the topology's hash. */
void world_toggle(fray_world *w, uint32_t field, uint32_t id, uint32_t value);
enum {
  TOPOLOGY_ROW = 1,
  TOPOLOGY_COUPLE = 2,
  TOPOLOGY_WARP = 3,
  TOPOLOGY_TRIANGLE = 4,
  TOPOLOGY_VERTEX = 5
};

/* Marks a row as dead and enters it into the topology's hash. */
void world_kill_row(fray_world *w, uint32_t row);
/* XOR over all dead rows and all couples, or all triangles and vertices, recomputed: what
 * state.topology must say. */
uint64_t world_topology(const fray_world *w);
/* The state's hash; cost: 9 words a particle. */
uint64_t world_hash(const fray_world *w);
/* Its pieces, which several workers can take: all but the particles; then, joined to it in this order,
 * the axes of each of the particles' arrays. These go from particle to particle: parts begin at a
 * multiple of HASH_LANES, where the part before has ended. */
typedef enum { HASHED_POSITIONS, HASHED_VELOCITIES, HASHED_REMAINDERS, HASHED } world_hashed;
void world_hash_begin(const fray_world *w, hash *h);
void world_hash_axes(const fray_world *w, world_hashed which, hash axes[3], uint32_t first,
                     uint32_t end);
/* Threshold of a structural row, Q16 strain: drawn from (seed, canonical row). */
int32_t world_threshold(const fray_world *w, uint32_t row);
/* Strain over which its ends are split: from the same draw, so always below its threshold. */
int32_t world_transition(const fray_world *w, uint32_t row);

#endif
