/* SPDX-License-Identifier: Apache-2.0 */
/* The world: pools carved once from the caller's memory. Stages read and write it; nothing here
 * moves by itself. Which arrays are constants, which are state and which live for one tick only
 * is the table in image/image_table.c. */
#ifndef FRAY_STATE_WORLD_H
#define FRAY_STATE_WORLD_H

#include "rt/base/vec.h"
#include "rt/state/blade.h"
#include "rt/state/rigid_body.h"
#include "rt/state/membrane_params.h"
#include "rt/state/contact_constraint.h"
#include "rt/state/contact_list.h"
#include "rt/state/crack_tips.h"
#include "rt/state/bend_plate.h"
#include "rt/state/elastic_step.h"
#include "rt/state/energy_ledger.h"
#include "rt/state/features.h"
#include "rt/state/handle.h"
#include "rt/state/triangle_pairs.h"
#include "rt/state/params.h"
#include "rt/state/tick_attempt.h"
#include "rt/state/spring.h"
#include "rt/state/self_pairs.h"
#include "rt/state/trimesh.h"
#include "rt/state/yarn_contact.h"
#include "rt/state/yarn_elastic.h"
#include "rt/state/yarn_grid.h"

/* Pools with their capacities, in the order of the image's header. */
typedef enum {
  POOL_PARAMS,
  POOL_STATE,
  POOL_PARTICLES,
  POOL_ATTACHED,
  POOL_CROSSINGS,
  POOL_SPRINGS,
  POOL_BATCHES,
  POOL_LINK_CLASSES,
  POOL_BEND_SHEAR_CLASSES,
  POOL_BODIES,
  POOL_KEYS,
  POOL_CONTACTS,
  POOL_BREAKS,
  POOL_SPLITS, /* a tick; not 0 iff the world has yarns */
  POOL_YARN_GAINS, /* as many as classes of links iff its yarns have a stiffness, else 0 */
  POOL_TRIANGLES, /* not 0 iff the world is a membrane and has no crossings */
  POOL_YARN_PAIRS, /* segments that may meet in a tick; not 0 iff yarns do not pass through each other */
  POOL_TRIANGLE_PAIRS, /* near triangles; not 0 iff triangles do not pass through each other */
  POOL_RIGID_MESH_WORDS, /* not 0 iff bodies are meshes */
  POOL_BLADES, /* 1 iff meshes cut its triangles, else 0 */
  POOLS_IN_HEADER,
  POOL_PATCHES = POOLS_IN_HEADER, /* of triangle self-collision, and pairs of these: by POOL_TRIANGLES */
  POOL_PATCH_PAIRS,
  POOL_YARN_CONTACTS, /* crossings that can split: one a spare particle, in worlds with yarns */
#if FRAY_CRACKS
  POOL_COROTATIONAL, /* 1 iff the membrane is isotropic, else 0: by the header's features */
  POOL_CRACKS, /* 1 iff it breaks, in the same way */
#endif
#if FRAY_HANDLES
  POOL_HANDLES, /* FRAY_HANDS iff a hand moves a handle, else 0: by the header's features */
#endif
#if FRAY_TRIANGLES && FRAY_MESHES
  POOL_ZONES, /* of a membrane whose ticks may be done again: its vertices or the bodies, and one; else 0 */
#endif
  POOLS
} pool_name;

/* A spring over its threshold, waiting to be cut. */
typedef struct {
  uint32_t spring;
  uint32_t excess; /* Q16 of (length / length at threshold)^2 - 1 */
} torn_spring;

/* Particles. Writers: integrate/ (positions, velocities, remainders), and every stage that moves them. */
typedef struct {
  int32_t *x, *y, *z;        /* Q24 lu */
  int32_t *vx, *vy, *vz;     /* Q28 lu per substep */
  /* One scratch by axis. Nothing else shares it, and no use outlasts its stage: */
  union {
    struct {
      int32_t *qx, *qy, *qz; /* a substep: predicted position, Q24 lu */
    };
    int32_t *tick_end[3];    /* blade_cut.c: position at the end of the tick, as predicted at its start */
    int32_t *unpulled[3];    /* until the pull of the first elastic step of yarns: velocities before it */
    int32_t *rounding[3];    /* yarn_stretch.c, from then on: what rounding of positions left */
    int32_t *seen;           /* image/validate*.c: marks, before the first tick */
  };
  uint32_t count;            /* in use: first one for each crossing or vertex, then the split ones */
  int8_t *rx, *ry, *rz;      /* remainder of the position below Q24, Q28 */
  const uint8_t *attach_body; /* attached particle -> body */
  const int32_t *attach_x, *attach_y, *attach_z; /* its position relative to the body, Q24 lu */
} particle_arrays;

/* The woven cloth (model 1). Writer: woven/. */
typedef struct {
  /* constants */
  const spring_batch *batches;     /* of links, then bend springs, then shear springs */
  const link_class *link_classes;  /* by class; 0 is unused */
  const bend_shear_class *bend_shear_classes;
  const index_t *crossing_particle; /* crossing -> particle; of split ones that of the weft */
  const index_t *canonical_id;     /* spring -> canonical spring */
  const index_t *spring_of;        /* canonical spring -> spring */
  const yarn_params *yarn_constants;
  const yarn_elastic_params *elastic_params;
  const yarn_gain *yarn_gains;     /* by class of links */
  /* state */
  index_t *spring_i, *spring_j;    /* ends */
  uint8_t *spring_kind;
  yarn_state *yarn_counts;
  uint8_t *crossing_state;         /* crossing -> fray_crossing_state, CROSSING_PENDING */
  index_t *warp_particle;          /* crossing -> particle of its warp */
  index_t *crossing_of;            /* particle -> crossing */
  yarn_contact *contacts;          /* of split crossings, see yarn_contact.h */
  /* of one tick */
  torn_spring *tear_queue;
  uint32_t tear_count;
  uint32_t tears_waiting;
  yarn_contact_step *contact_steps; /* of a contact of yarns */
#if FRAY_ENERGY
  metered_yarn *metered;           /* energy/energy_yarn_step.c, where the world is watched */
#endif
} woven_state;

/* The triangle cloth beside its mesh (model 2). Writer: membrane/. */
typedef struct {
  /* constants, by material */
  const membrane_params *constants;
  const material_table *materials;
  const tear_strength *tear_strengths;
  const blade_params *blades;      /* of worlds with blades */
  /* state */
  stiffness_state *stiffness;      /* of a triangle */
  bend_state *bend_states;         /* of a triangle */
  /* follows from the mesh */
  bend_shape *bend_shapes;         /* of a triangle */
  /* of one tick */
  membrane_gain *gains;            /* of a triangle */
  int32_t *strain_threshold;       /* of a triangle, Q28: membrane/strain_law.h */
  material_tensor *stress;         /* of a triangle when a tick begins, Q12 N/m; see membrane_last_stress() */
  int32_t *plates;                 /* of a triangle: PLATE_COLUMNS */
  int32_t *folds;                  /* of a side between two triangles: FOLD_COLUMNS */
  bend_normal *normals;            /* of a triangle, in a bending step */
  bend_moment *moments;
  uint32_t fold_count;
  uint8_t bend_current;            /* 0: tears or cuts have changed the mesh since they were found */
  uint8_t bend_faded;              /* 1: the angle of some counts less, for triangles pressed together */
  uint8_t at_edge;                 /* 1: a vertex may reach the edge of the world in this substep */
  uint8_t constraints_missed;      /* 1: in this substep some had no room; of elastic yarns too */
  int32_t *inverse_mass;           /* of a vertex: Q24 of 1 / particle mass */
  elastic_position *positions;     /* of a vertex */
  int32_t *low_x, *low_y, *low_z;  /* of a vertex: its position below Q28, Q59 */
  union {
    elastic_impulse *impulse;      /* of a vertex, in an elastic step */
    elastic_impulse *max_stress;   /* membrane_tear.c: bounds of the stress around a vertex */
  };
  elastic_impulse *forced;           /* that of the forces of the step alone */
  elastic_impulse *external_impulse; /* that of loads and wind */
#if FRAY_ENERGY
  metered_impulse *metered_impulses; /* membrane/step_meter.c, where the world is watched */
  metered_body *metered_bodies;
#endif
  elastic_body *bodies;
  contact_constraint *constraints; /* of a substep */
  uint32_t constraint_count;
  limited_edge *limited_edges; /* of a substep */
  uint32_t limited_edge_count;
  uint8_t *passing_blade;          /* vertex -> 1: all of its triangles pass a blade */
  uint8_t *near_blade;             /* triangle -> 1: passing a blade, and near a sharp mesh in this tick */
#if FRAY_CRACKS
  const crack_params *crack_constants;
  crack_state *cracks;
  uint32_t *averaged;              /* triangle -> the last average of this tick that it is in */
  uint32_t averages;
#endif
} membrane_state;

/* Rigid bodies. Writers: haptics/ and integrate/; contact/ adds impulses. */
typedef struct {
  const rigid_body *bodies;
  const keyframe *keyframes;
  const int32_t *mesh_words;       /* see state/rigid_mesh.h */
  uint32_t sharp_meshes;           /* a bit each; as long as the world */
  body_state *states;              /* state */
  body_motion *motion;             /* of one tick */
  vec3 *start;                     /* body -> position at the start of the substep; with rigid meshes only */
} rigid_state;

/* Contacts of cloth and bodies, of one tick. Writer: contact/. */
typedef struct {
  contact *list;
  uint32_t count;
  uint32_t gathered;               /* contacts with other bodies than meshes */
  int32_t *start_x, *start_y, *start_z; /* at the start of the substep, Q24 lu */
  int32_t rise;                    /* out of an overlap, in a substep at most; Q24 lu */
  uint8_t *side_mask;              /* particle -> CONTACT_RELEASED, sides of a collider's box (collider.h) */
  index_t *near_triangles;         /* cloth triangles near the mesh */
} contact_state;

/* Self-collision of both models. Writer: self_collision/. */
typedef struct {
  const self_params *constants;
  self_path *paths;                /* of a particle */
  self_zone *zones;                /* of a particle that is the root of its impact zone */
  index_t *zone_of;                /* particle -> towards that root */
  uint8_t *moved_round;            /* particle -> the round in which it was moved last */
  uint32_t merged;
  uint8_t round;
} self_state;

/* Self-collision of yarns, of one tick. Writer: self_collision/yarn_collision*. */
typedef struct {
  self_grid_path *grid_paths;      /* of a particle */
  self_box *boxes;                 /* a tree over the crossings */
  uint32_t *rough_before;          /* crossing -> how many before it are not spread out flat */
  self_pair *pairs;
  uint32_t pair_count;
  uint32_t without_room;           /* pairs of the tick for which the pool had no room */
  uint32_t particles_before;       /* in use when the tick began */
  uint8_t pass;                    /* over the tick's paths, from 0 */
  uint8_t bound_met;               /* the search of this tick is not complete */
  uint8_t moved_without_room;      /* some of these were moved in this pass, so others may touch by that */
} yarn_collision_state;

/* Self-collision of triangles: a cache that ticks share, never state. Writer:
 * self_collision/triangle_collision*. */
typedef struct {
  triangle_pair *pairs;
  uint32_t *active;                /* pairs that may meet in this tick; behind them, room to sort them */
  triangle_travel *travel;         /* of a triangle */
  int32_t *predicted_travel;       /* of a triangle: with this tick; TRIANGLE_PAIR_STALE */
  triangle_box *boxes;             /* of a triangle */
  index_t *order;                  /* triangles by patches */
  box_cluster *clusters;
  index_t *stale;                  /* triangles whose pairs are to be found anew */
  uint32_t *pair_counts;           /* of a triangle */
  triangle_patch *patches;
  patch_pair *patch_pairs;
  triangle_pair_list *list;
  self_constraint *constraints;    /* of a tick: attempt.begin->constraints */
} triangle_collision_state;

#if FRAY_HANDLES
/* Handles, by hand. Writers: haptics/, and elastic/step_handles.c in steps. */
typedef struct {
  const handle_params *constants;
  handle_state *states;
  handle_motion *motion;           /* of one tick */
} handle_table;
#endif

/* What a tick answers to its hands. Writer: haptics/. */
typedef struct {
  uint8_t answered, answer_counter, result;
  int32_t force_unlimited[FRAY_HANDS][3];
} haptic_state;

struct fray_world {
  world_features features;
  uint32_t capacity[POOLS];
  fray_kernel kernel;
  uint32_t physics_id;             /* of the image */
  const params *params;
  state *state;
  particle_arrays p;
  woven_state woven;
  rigid_state rigid;
  contact_state contact;
  trimesh trimesh;
  membrane_state membrane;
  self_state self;
  yarn_collision_state yarn;
  triangle_collision_state tri;
  tick_attempt attempt;
  haptic_state haptic;
#if FRAY_HANDLES
  handle_table handles;
#endif
  uint32_t first_tear;             /* of this tick: canonical spring or vertex; see fray_output */
  vec3 gravity_step;               /* of this substep, Q28 */
  fray_work work;
#if FRAY_ENERGY
  energy_ledger energy;            /* no part of the state */
#endif
};

/* Sets a sticky fault. */
static inline void world_fault(fray_world *w, uint32_t fault) { w->state->faults |= (int32_t)fault; }

/* Particles 0 to particles_attached() - 1 are carried by bodies. */
static inline uint32_t particles_attached(const fray_world *w) { return (uint32_t)w->params->attached; }
static inline int particle_is_attached(const fray_world *w, uint32_t p) { return p < particles_attached(w); }
static inline uint32_t triangles_in_use(const fray_world *w) { return (uint32_t)w->trimesh.state->triangles; }

static inline uint32_t bend_fold_stride(const fray_world *w) { return 3u * w->capacity[POOL_TRIANGLES] / 2u; }
static inline int32_t *bend_fold_column(const fray_world *w, uint32_t column) {
  FRAY_ASSERT(column < FOLD_COLUMNS);
  return w->membrane.folds + column * bend_fold_stride(w);
}
static inline int32_t *bend_plate_column(const fray_world *w, uint32_t column) {
  FRAY_ASSERT(column < PLATE_COLUMNS);
  return w->membrane.plates + column * w->capacity[POOL_TRIANGLES];
}
/* The stress of the last elastic step, once the tick has no use for that of its beginning: columns of uu, vv,
 * uv, each as long as triangles_in_use(), as membrane_force.c has them. */
static inline int32_t *membrane_last_stress(const fray_world *w) {
  return (int32_t *)(void *)w->membrane.stress;
}
/* Of H of a triangle, between two sides. */
static inline int32_t *bend_plate_entry(const fray_world *w, uint32_t i, uint32_t j) {
  static const uint8_t entry[3][3] = {{PLATE_H00, PLATE_H01, PLATE_H02},
                                      {PLATE_H01, PLATE_H11, PLATE_H12},
                                      {PLATE_H02, PLATE_H12, PLATE_H22}};
  FRAY_ASSERT(i < 3 && j < 3);
  return bend_plate_column(w, entry[i][j]);
}
/* About side k of a triangle, of the angles of a bending step; Q(bend_bits + BEND_ANGLE_BITS). */
static inline int64_t bend_plate_moment(const fray_world *w, uint32_t t, uint32_t k) {
  const int32_t *angle = w->membrane.moments[t].side;
  return fx_mul_wide(bend_plate_entry(w, k, 0)[t], angle[0]) +
         fx_mul_wide(bend_plate_entry(w, k, 1)[t], angle[1]) +
         fx_mul_wide(bend_plate_entry(w, k, 2)[t], angle[2]);
}

static inline vec3 world_position(const fray_world *w, uint32_t p) {
  return vec_make(w->p.x[p], w->p.y[p], w->p.z[p]);
}
static inline vec3 world_velocity(const fray_world *w, uint32_t p) {
  return vec_make(w->p.vx[p], w->p.vy[p], w->p.vz[p]);
}
/* No faster than a particle may be. */
static inline vec3 world_body_velocity(const fray_world *w, uint32_t b) {
  return vec_clamp_rare(vec_of(w->rigid.states[b].velocity), FX_SPEED_MAX);
}
/* So that a move of the position, by as much, does not change the velocity. */
static inline void world_shift_predicted(fray_world *w, uint32_t p, vec3 by) {
  w->p.qx[p] = fx_wrap_add(w->p.qx[p], by.x);
  w->p.qy[p] = fx_wrap_add(w->p.qy[p], by.y);
  w->p.qz[p] = fx_wrap_add(w->p.qz[p], by.z);
}
static inline void world_count_tears(fray_world *w, uint32_t tears) {
  w->state->tears_total = fx_add_saturated(w->state->tears_total, (int32_t)tears);
}
static inline void world_set_velocity(fray_world *w, uint32_t p, vec3 v) {
  w->p.vx[p] = v.x;
  w->p.vy[p] = v.y;
  w->p.vz[p] = v.z;
}
static inline yarn_grid world_yarn_grid(const fray_world *w) {
  const yarn_grid grid = {(uint32_t)w->params->warps, (uint32_t)w->params->wefts};
  return grid;
}

/* Batches of one kind that follow one another, from *b on: the end of their rows; *b moves behind
 * them. Rows without gaps, so that a scalar loop takes them in one go. */
static inline uint32_t world_batch_run(const fray_world *w, uint32_t *b, uint32_t batches) {
  FRAY_ASSERT(*b < batches && batches <= w->capacity[POOL_BATCHES]);
  const int32_t held = w->woven.batches[*b].attached;
  do ++*b;
  while (*b < batches && w->woven.batches[*b].attached == held);
  return (uint32_t)(w->woven.batches[*b - 1u].first + w->woven.batches[*b - 1u].count);
}

/* What a world has: read once from its capacities, when it is opened. */
static inline void world_find_features(fray_world *w) {
  const uint32_t *const pool = w->capacity;
  w->features.membrane = pool[POOL_TRIANGLES] != 0;
  w->features.yarns = pool[POOL_SPLITS] != 0;
  w->features.shear_lock = pool[POOL_LINK_CLASSES] > CLASS_LOCK;
  w->features.elastic_yarns = pool[POOL_YARN_GAINS] != 0;
  w->features.rigid_meshes = pool[POOL_RIGID_MESH_WORDS] != 0;
  w->features.yarn_collision = pool[POOL_YARN_PAIRS] != 0;
  w->features.triangle_collision = pool[POOL_TRIANGLE_PAIRS] != 0;
  w->features.blades = pool[POOL_BLADES] != 0;
}

static inline int world_has_membrane(const fray_world *w) { return FRAY_TRIANGLES && w->features.membrane; }
static inline int world_has_yarns(const fray_world *w) { return FRAY_YARNS && w->features.yarns; }
static inline int world_has_shear_lock(const fray_world *w) { return w->features.shear_lock; }
static inline int world_has_elastic_yarns(const fray_world *w) {
  return FRAY_STRETCH && w->features.elastic_yarns;
}
/* Links move positions, once a substep. */
static inline int world_is_projected(const fray_world *w) {
  return !world_has_membrane(w) && !world_has_elastic_yarns(w);
}
static inline int world_has_rigid_meshes(const fray_world *w) {
  return FRAY_MESHES && w->features.rigid_meshes;
}
/* Particle -> CONTACT_RELEASED where bodies let it pass in this tick. Without meshes only until the first
 * substep: it is where predicted positions will be. */
static inline uint8_t *world_released(const fray_world *w) {
  return world_has_rigid_meshes(w) ? w->contact.side_mask : (uint8_t *)w->p.qx;
}
static inline int world_is_released(const fray_world *w, uint32_t p) {
  return world_is_projected(w) && (world_released(w)[p] & CONTACT_RELEASED) != 0;
}
static inline int world_has_yarn_collision(const fray_world *w) {
  return FRAY_YARN_COLLISION && w->features.yarn_collision;
}
static inline int world_has_triangle_collision(const fray_world *w) {
  return FRAY_TRIANGLE_COLLISION && w->features.triangle_collision;
}
static inline uint32_t world_zones(const fray_world *w) {
#if FRAY_TRIANGLES && FRAY_MESHES
  return w->capacity[POOL_ZONES];
#else
  (void)w;
  return 0;
#endif
}
/* A tick may be done again (tick/rollback.h). */
static inline int world_repeats_ticks(const fray_world *w) { return world_zones(w) != 0; }
/* Of what moves as one in it: without self-collision that is what a body stops. */
static inline fray_energy_stage world_zone_stage(const fray_world *w) {
  return world_has_triangle_collision(w) ? FRAY_ENERGY_SELF_COLLISION : FRAY_ENERGY_CONTACT;
}
static inline int world_has_blades(const fray_world *w) {
  return FRAY_MESHES && FRAY_TRIANGLES && w->features.blades;
}

static inline int world_is_corotational(const fray_world *w) {
#if FRAY_CRACKS
  return w->capacity[POOL_COROTATIONAL] != 0;
#else
  (void)w;
  return 0;
#endif
}

static inline int world_has_cracks(const fray_world *w) {
#if FRAY_CRACKS
  return w->capacity[POOL_CRACKS] != 0;
#else
  (void)w;
  return 0;
#endif
}

static inline int world_has_handles(const fray_world *w) {
#if FRAY_HANDLES
  return w->capacity[POOL_HANDLES] != 0;
#else
  (void)w;
  return 0;
#endif
}
/* Enters or takes an entry out of the topology's hash. */
void world_toggle_entry(fray_world *w, uint64_t entry);
void world_toggle(fray_world *w, uint32_t field, uint32_t id, uint32_t value);
enum {
  TOPOLOGY_SPRING = 1,
  TOPOLOGY_CROSSING = 2,
  TOPOLOGY_WARP = 3,
  TOPOLOGY_TRIANGLE = 4,
  TOPOLOGY_VERTEX = 5
};

/* Marks a row as dead and enters it into the topology's hash. */
void world_kill_spring(fray_world *w, uint32_t row);
/* XOR over all dead rows and all couples, or all triangles and vertices, recomputed: what
 * state.topology must say. */
uint64_t world_topology(const fray_world *w);
/* Threshold of a structural row, Q16 strain: drawn from (seed, canonical row). */
int32_t world_tear_strain(const fray_world *w, uint32_t row);
/* Strain over which its ends are split: from the same draw, so always below its threshold. */
int32_t world_split_strain(const fray_world *w, uint32_t row);

#endif
