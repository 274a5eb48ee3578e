/* SPDX-License-Identifier: Apache-2.0 */
/* fray: cloth that stretches, frays, tears and is cut, in fixed point, one pure tick at a time.
 *
 * This is the whole public interface of the runtime. A world lives in memory that the caller owns, and a
 * tick maps (world, input) to (world, output). The same image and the same inputs give the same hash after
 * every tick on every machine. Nothing here allocates, locks, reads a clock, does I/O or keeps a global.
 *
 * Units: lengths are in lu (length units, fray_get_info().lu_um micrometres each), Q24: the integer 1 <<
 * 24 is one lu. Velocities are Q28 lu per substep. Forces are 0.5 mN a step. Poses are 2 um a step.
 *
 * Contract, where a function does not say otherwise:
 *   Context: thread or interrupt; one world in one context at a time. Worlds are independent.
 *   NULL: no pointer may be NULL, and no index out of its range: FRAY_CHECKED builds trap.
 *   Views are valid until the next tick. */
#ifndef FRAY_H
#define FRAY_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FRAY_VERSION "0.5.0"
#define FRAY_IMAGE_MAJOR 3u
#define FRAY_IMAGE_MINOR 1u /* the newest: an image says the oldest that has what it needs */

enum { FRAY_HANDS = 2 };

typedef struct fray_world fray_world;

typedef enum {
  FRAY_OK = 0,
  FRAY_BAD_ARGUMENT, /* a null pointer, or memory not aligned to FRAY_ALIGN */
  FRAY_TRUNCATED,    /* fewer bytes than the header, or than the header's length field */
  FRAY_BAD_MAGIC,
  FRAY_BAD_VERSION,  /* another major version, or features this build does not have */
  FRAY_BAD_CRC,
  FRAY_BAD_SECTION,  /* a section missing, doubled, of the wrong size, or out of bounds */
  FRAY_BAD_FIELD,    /* a value outside its range */
  FRAY_BAD_BATCH,    /* two springs of one batch share a particle, or the batches have gaps */
  FRAY_SMALL_MEMORY  /* the caller's memory is smaller than fray_memory_size() says */
} fray_status;

/* Where an image was refused. `what` is a constant string: what was expected there. */
typedef struct {
  fray_status status;
  uint32_t section; /* section id, 0 for the header */
  uint32_t index;   /* element in the section */
  const char *what;
} fray_error;

enum { FRAY_ALIGN = 16 };

/* Bytes of memory that fray_open() needs for this image. Errors: as of fray_open(), from the header alone.
 * NULL: `image` or `bytes` is FRAY_BAD_ARGUMENT; error may be NULL. Cost: constant. */
fray_status fray_memory_size(const void *image, size_t image_bytes, size_t *bytes, fray_error *error);

/* Validates an image and builds its world in the caller's memory, aligned to FRAY_ALIGN. `image` must
 * outlive the world and stay as it is: constants are used in place where byte order, index width and
 * alignment allow. Errors: on any status but FRAY_OK, *world is NULL and *error says where. NULL: `image`,
 * `memory` or `world` is FRAY_BAD_ARGUMENT; error may be NULL. Cost: linear in the image's length, whatever
 * the image holds: of the pools that only its header bounds nothing is written. */
fray_status fray_open(const void *image, size_t image_bytes, void *memory, size_t memory_bytes,
                      fray_world **world, fray_error *error);

/* The code path of the hot loops: same bits, other speed. A world begins with SCALAR. */
typedef enum { /* AVX512: F, BW, DQ, VL */
  FRAY_KERNEL_SCALAR, FRAY_KERNEL_AVX2, FRAY_KERNEL_AVX512, FRAY_KERNEL_NEON, FRAY_KERNEL_HELIUM
} fray_kernel;
/* Returns 1, or 0 where this build lacks the kernel; the world then keeps its kernel. The caller knows
 * whether the processor has the instructions (platform/linux/cpu.h asks it). Cost: constant. */
int fray_set_kernel(fray_world *world, fray_kernel kernel);

/* The device's position, 2 um a step from its origin. */
typedef struct {
  int16_t x, y, z;
  uint8_t counter; /* 0..15: that of the frame */
  uint8_t buttons; /* 0..15 */
} fray_pose;

typedef enum {
  FRAY_COMMAND_NONE = 0,
  FRAY_COMMAND_START, /* READY -> OPERATIONAL as soon as every hand has sent enough good poses */
  FRAY_COMMAND_STOP,  /* OPERATIONAL -> READY; forces fade out; withdraws a pending START */
  FRAY_COMMAND_RESET, /* SAFE -> READY; clears the sticky faults */
  FRAY_COMMAND_ZERO,  /* OPERATIONAL: forces fade to zero and stay zero until the next START */
  FRAY_COMMAND_HALT   /* any state -> SAFE, forces zero at once; the loop sends it when the bus is lost */
} fray_command;

/* The input of one tick: at most one pose a hand and one command. */
typedef struct {
  uint8_t has_pose; /* bit h: pose[h] arrived for this tick */
  fray_pose pose[FRAY_HANDS];
  uint8_t command;  /* fray_command */
  uint8_t command_counter;
} fray_input;

typedef enum { FRAY_READY = 1, FRAY_OPERATIONAL = 2, FRAY_SAFE = 3 } fray_state;

/* Sticky fault bits; FRAY_COMMAND_RESET clears them in SAFE (HALT leads there). X(name, bit, STATUS signal,
 * cause, advice): enum, dictionary, `fray run` and page (rt/wire/README.md, "Faults") are made of this. */
#define FRAY_FAULTS(X) \
  X(FRAY_FAULT_STALE_LEFT, 0, "StaleLeft", \
    "The left hand sent no good pose for too many ticks; the world went to SAFE.", \
    "Check the device and its cable, then send RESET and START.") \
  X(FRAY_FAULT_STALE_RIGHT, 1, "StaleRight", \
    "The right hand sent no good pose for too many ticks; the world went to SAFE.", \
    "Check the device and its cable, then send RESET and START.") \
  X(FRAY_FAULT_CONTACTS_FULL, 2, "ContactsFull", \
    "More particles or triangles are near bodies than the contact pool holds; the rest met no body in this " \
    "tick.", \
    "Raise `contacts` in the limits of the scene.") \
  X(FRAY_FAULT_BREAK_BUDGET, 3, "BreakBudget", \
    "More springs were over their thresholds, or more blade cuts due, than one tick may make; the rest is " \
    "left for later ticks.", \
    "Raise `tears_per_tick` in the limits of the scene, or accept the delay.") \
  X(FRAY_FAULT_OUT_OF_WORLD, 4, "OutOfWorld", \
    "A particle or body was held back at the edge of the world, 60 lu from its origin.", \
    "Look for pieces that fall without end and for bodies that move too far.") \
  X(FRAY_FAULT_HALTED, 5, "Halted", \
    "HALT: the bus was lost, its authentication failed, or an operator sent it; the world went to SAFE.", \
    "Mend the cause, then send RESET and START.") \
  X(FRAY_FAULT_PARTICLES_FULL, 6, "ParticlesFull", \
    "No spare particle is left: a crossing stays whole, or a membrane does not tear there.", \
    "Raise `spare_particles` in the limits of the scene.") \
  X(FRAY_FAULT_SPLIT_BUDGET, 7, "SplitBudget", \
    "More crossings were due to split or disconnect than one tick may change; the rest follows later.", \
    "Raise `splits_per_tick` in the limits of the scene, or accept the delay.") \
  X(FRAY_FAULT_SELF_COLLISION_BUDGET, 8, "SelfCollisionBudget", \
    "Self-collision ran out of pairs, visits or rounds: what it found was pushed apart; yarns that it left " \
    "out may have passed through each other, or parts of the cloth moved together for a tick.", \
    "Raise `self_collision_pairs` in the limits of the scene; if the bit comes back, the cloth is too " \
    "crowded or moves too fast.") \
  X(FRAY_FAULT_CONTACT_UNRESOLVED, 9, "ContactUnresolved", \
    "Cloth between bodies has no free place, no correction kept it out, or drawn links let it pass.", \
    "Leave room for the cloth between bodies, and move them more slowly.") \
  X(FRAY_FAULT_MESH_QUERY_BUDGET, 10, "MeshQueryBudget", \
    "More of a mesh was near a path than a test may take; yarns kept their place, membranes pass the rest.", \
    "Use a coarser mesh, or move more slowly.") \
  X(FRAY_FAULT_TRIANGLES_FULL, 11, "TrianglesFull", \
    "No spare triangle is left: a membrane does not tear or is not cut there.", \
    "Raise `spare_triangles` in the limits of the scene.") \
  X(FRAY_FAULT_OVERSTRETCHED, 12, "Overstretched", \
    "A membrane was drawn to three times its length, a yarn to the largest force of a step, or a free " \
    "body beyond the reach of its cloth.", \
    "Give the cloth a strain limit or a strength, a lighter body, or more substeps; draw it less far.") \
  X(FRAY_FAULT_SPEED_LIMIT, 13, "SpeedLimit", "A vertex came to the limit of speed, 4 lu a substep.", \
    "Take lighter loads or heavier cloth, a higher rate or more substeps.")

#define FRAY_FAULT_VALUE(name, bit, signal, cause, action) name = 1u << (bit),
#define FRAY_FAULT_OR(name, bit, signal, cause, action) name |
enum { FRAY_FAULTS(FRAY_FAULT_VALUE) FRAY_FAULTS_ALL = FRAY_FAULTS(FRAY_FAULT_OR) 0u };
#undef FRAY_FAULT_VALUE
#undef FRAY_FAULT_OR

/* Refused: the command does not apply in this state. */
typedef enum { FRAY_RESULT_OK = 0, FRAY_RESULT_REFUSED = 1, FRAY_RESULT_UNKNOWN = 2 } fray_result;

/* Counted work of one tick. */
typedef struct {
  uint32_t particle_steps;    /* particles x substeps; of a membrane x elastic steps */
  uint32_t projections;       /* projected springs, and locked diagonals, x iterations x substeps */
  uint32_t springs;           /* bend and shear springs */
  uint32_t contacts;          /* candidate contacts x substeps */
  uint32_t tear_tests;        /* structural springs, or triangles */
  uint32_t tears;             /* springs broken, or vertices and edges torn and cut */
  uint32_t broad_phase_tests; /* free particles x bodies with a surface, x substeps of elastic yarns */
  uint32_t over_threshold;    /* structural springs found over their tear strain */
  uint32_t transitions;       /* structural springs tested for splitting, crossings for disconnecting */
  uint32_t splits;            /* crossings split, loosened or disconnected */
  uint32_t slips;             /* connected and loose crossings x substeps, x elastic steps */
  uint32_t yarn_forces;       /* structural springs x elastic steps x substeps, twice with damping */
  uint32_t tear_candidates;   /* lines along which the membrane was tested for a tear */
  uint32_t eigenvalues;       /* vertices of an isotropic sheet whose principal stress was looked at */
  uint32_t element_forces;    /* triangles x elastic steps x substeps */
  uint32_t bend_forces;       /* folds between triangles x their bending steps */
  uint32_t mesh_tests;        /* paths of particles tested against the box of a rigid mesh or sphere */
  uint32_t mesh_boxes;        /* boxes of rigid meshes' trees tested */
  uint32_t mesh_ccd;          /* continuous collision tests with rigid meshes and spheres */
  uint32_t mesh_pins;         /* particles returned to the start of the substep, beside a body */
  uint32_t self_box_tests;    /* boxes tested. Of a membrane this and self_ccd depend on a cache, no state */
  uint32_t self_pairs;        /* segments, or a vertex and a triangle, or two edges, that may meet */
  uint32_t self_ccd;          /* continuous collision tests of these, and tests of yarns at bodies */
  uint32_t self_merged;       /* particles merged into impact zones */
  uint32_t blade_cuts;        /* of the tears, those made by blades */
  uint32_t contact_constraints; /* of a membrane, with bodies and itself: constraints x elastic steps */
} fray_work;

typedef struct {
  uint64_t tick;                          /* of this output, from 0; on the bus its low 32 bits */
  uint64_t hash;                          /* of the state after it */
  int16_t force[FRAY_HANDS][3];           /* 0.5 mN a step, after ramp, rate limit and clamp */
  int32_t force_unlimited[FRAY_HANDS][3]; /* 0.5 mN a step, before them */
  uint8_t consumed[FRAY_HANDS];           /* counter of the last pose consumed; 0 before the first */
  uint8_t state;                          /* fray_state */
  uint8_t answered;                       /* the command answered in this tick, or FRAY_COMMAND_NONE */
  uint8_t answer_counter;                 /* its counter */
  uint8_t result;                         /* its fray_result */
  uint16_t faults;                        /* FRAY_FAULT_*, sticky */
  uint32_t tears_waiting; /* springs over their tear strain that the break budget left for the next tick */
  uint32_t first_tear;    /* where work.tears > 0: the first canonical spring, or vertex of a membrane */
  uint32_t tears_total;
  uint32_t splits_waiting; /* crossings that the split budget left for the next tick */
  uint32_t crossings_connected, crossings_loose, crossings_disconnected; /* of the whole cloth */
  fray_work work;
} fray_output;

/* Advances the world by one tick. Never fails: what exceeds a pool or a budget is skipped in a defined
 * order, and a bit of output->faults names it. Cost: bounded by the image (fray_work_bound); independent
 * of the clock. */
void fray_tick(fray_world *world, const fray_input *input, fray_output *output);

/* The id of this library's physics: equal ids give equal bits. fray_info has the image's. Cost: constant. */
uint32_t fray_physics_id(void);

/* The hash that the last tick reported; after fray_open() that of the image's state. Cost: constant. */
uint64_t fray_hash(const fray_world *world);

/* Bytes that fray_save() writes. Cost: constant. */
size_t fray_save_bytes(const fray_world *world);
/* Saves the world as an image; opening it and going on gives the same hashes. Returns the bytes written,
 * or 0 iff the buffer is NULL or buffer_bytes < fray_save_bytes(); then it is untouched. Cost: linear in
 * the image. */
size_t fray_save(const fray_world *world, void *buffer, size_t buffer_bytes);

/* The most work that any tick of this world can count. Cost: linear in batches and bodies. */
fray_work fray_work_bound(const fray_world *world);

/* ---- energy ----
 *
 * What a world stores, what it was supplied with, and what each stage of its ticks made or lost, since it is
 * watched (rt/energy/README.md): at any time
 *
 *   sum of stored - begun = sum of supplied + sum of made - sum of lost
 *
 * to FRAY_ENERGY_ROUNDING units. A unit is 2^-40 of a particle's mass times (lu per substep)^2, in joules
 * 2^-40 * particle_mass_ng * 1e-24 * (lu_um * rate_hz * substeps)^2. Watching changes no bit of a world and
 * is no part of its images; one worker computes a watched tick. Builds with FRAY_ENERGY=0, as those for small
 * and bare machines are, do not have these functions. */
#define FRAY_ENERGY_STORE_ROWS(X) \
  X(FRAY_STORED_KINETIC, "kinetic")   /* of free particles, in the middle of two steps */ \
  X(FRAY_STORED_BODIES, "bodies")     /* kinetic, of free bodies */ \
  X(FRAY_STORED_STRETCH, "stretch")   /* of a membrane */ \
  X(FRAY_STORED_SHEAR, "shear") \
  X(FRAY_STORED_BEND, "bend") \
  X(FRAY_STORED_YARNS, "yarns")       /* elastic yarns */ \
  X(FRAY_STORED_HANDLES, "handles")   /* springs of handles */ \
  X(FRAY_STORED_POTENTIAL, "potential") /* of free particles and bodies against the origin */
#define FRAY_ENERGY_SUPPLY_ROWS(X) \
  X(FRAY_SUPPLIED_WIND, "wind") \
  X(FRAY_SUPPLIED_LOADS, "loads") \
  X(FRAY_SUPPLIED_BODIES, "work_bodies") /* fixed ones and those on paths */ \
  X(FRAY_SUPPLIED_HANDS, "work_hands")
#define FRAY_ENERGY_STAGE_ROWS(X) \
  X(FRAY_ENERGY_STEPS, "steps")       /* motion under elastic forces and gravity */ \
  X(FRAY_ENERGY_DRAG, "drag") \
  X(FRAY_ENERGY_DAMPING, "damping") \
  X(FRAY_ENERGY_LIMITS, "limits")     /* of strain, of speed, and the edge of the world */ \
  X(FRAY_ENERGY_SLIP, "slip")         /* yarns on yarns */ \
  X(FRAY_ENERGY_CONTACT, "contact")   /* with bodies: pushes and friction */ \
  X(FRAY_ENERGY_SELF_COLLISION, "self_collision") \
  X(FRAY_ENERGY_TEARS, "tears")       /* tears, splits and cuts */ \
  X(FRAY_ENERGY_MATERIAL, "material") /* a stiffness that follows the strain; bending that is prepared anew */
#define FRAY_ENERGY_NAME(name, text) name,
typedef enum { FRAY_ENERGY_STORE_ROWS(FRAY_ENERGY_NAME) FRAY_ENERGY_STORES } fray_energy_store;
typedef enum { FRAY_ENERGY_SUPPLY_ROWS(FRAY_ENERGY_NAME) FRAY_ENERGY_SUPPLIES } fray_energy_supply;
typedef enum { FRAY_ENERGY_STAGE_ROWS(FRAY_ENERGY_NAME) FRAY_ENERGY_STAGES } fray_energy_stage;
#undef FRAY_ENERGY_NAME
enum { FRAY_ENERGY_ROUNDING = 2 * FRAY_ENERGY_STAGES + FRAY_ENERGY_STORES + FRAY_ENERGY_SUPPLIES };

/* In units, saturated. A stage's net of each tick goes to what it made where it is above 0, else to what it
 * lost: neither is below 0. */
typedef struct {
  uint64_t ticks;                         /* since it is watched, and the ledger has begun */
  int64_t begun;                          /* sum of stored when it began */
  int64_t stored[FRAY_ENERGY_STORES];     /* now */
  int64_t supplied[FRAY_ENERGY_SUPPLIES];
  int64_t gravity;                        /* its work: what the potential has lost */
  int64_t made[FRAY_ENERGY_STAGES], lost[FRAY_ENERGY_STAGES];
  uint32_t fastest_vertex;                /* the free particle that was fastest at the end of a tick */
  uint32_t fastest_speed;                 /* Q28 lu per substep, saturated */
  uint64_t fastest_tick;
} fray_energy_account;

/* Begins the account anew, in the next tick. Cost: constant; a watched tick takes several times as long. */
void fray_energy_watch(fray_world *world);
/* The account of a watched world; of one that is not watched all 0. Cost: constant. */
fray_energy_account fray_energy(const fray_world *world);

/* ---- one tick by several workers ----
 *
 * A schedule divides the ticks of one world into steps for a fixed number of workers. They compute what
 * fray_tick() computes, to the last bit, whatever their number. The runtime has no threads: the caller
 * gives each worker one, and in every tick worker w runs its steps 0, 1, ... fray_parallel_steps() - 1,
 * each as soon as its dependency is done:
 *
 *   for (uint32_t n = 0; n < fray_parallel_steps(p); ++n) {
 *     wait until fray_parallel_dependency(p, w, n) is done;      acquire: writes of that worker are visible
 *     fray_parallel_step(p, w, n, &input, &output);
 *     publish that worker w has done n + 1 steps;                release
 *   }
 *
 * platform/linux/workers.h does this with threads. Between ticks the world is as after fray_tick(): it can
 * be saved, viewed, or advanced by fray_tick().
 *
 * Context: threads; in a tick, steps of different workers run at the same time, all else as above. */
enum { FRAY_WORKERS_MAX = 16, FRAY_ALL_WORKERS = FRAY_WORKERS_MAX, FRAY_PARALLEL_ALIGN = 64 };

typedef struct fray_parallel fray_parallel;

/* `steps` steps of `worker`, or of each of FRAY_ALL_WORKERS, must be done in this tick. 0: no dependency. */
typedef struct {
  uint32_t worker;
  uint32_t steps;
} fray_dependency;

/* How many workers are of use to this world: 1 where it is too small, or cannot be divided. workers_max: any.
 * Cost: constant. */
uint32_t fray_parallel_useful(const fray_world *world, uint32_t workers_max);

/* Bytes of memory that a schedule needs. workers: 1..FRAY_WORKERS_MAX. Cost: constant. */
size_t fray_parallel_memory_size(const fray_world *world, uint32_t workers);

/* Makes the schedule in the caller's memory, aligned to FRAY_PARALLEL_ALIGN; memory and world must outlive
 * it. Returns NULL iff a pointer is NULL, `workers` is not in 1..FRAY_WORKERS_MAX (workers: any), or the
 * memory is too small or not aligned. Cost: linear in the structural springs. */
fray_parallel *fray_parallel_open(fray_world *world, uint32_t workers, void *memory, size_t memory_bytes);

/* 1 iff the springs still have the ends for which the schedule was made. Breaks keep it; where springs get
 * other ends, open it again. Cost: linear in the structural springs. */
int fray_parallel_holds(const fray_parallel *parallel);

/* Steps of a tick, the same for all workers. Cost: constant. */
uint32_t fray_parallel_steps(const fray_parallel *parallel);
/* worker < workers, step < fray_parallel_steps(). Cost: constant. */
fray_dependency fray_parallel_dependency(const fray_parallel *parallel, uint32_t worker, uint32_t step);
/* Runs a step. worker < workers, step < fray_parallel_steps(). Only worker 0 uses input and output; the
 * others may pass NULL. Cost: all steps of a tick together as fray_tick(), and a few hundred instructions
 * a step. */
void fray_parallel_step(fray_parallel *parallel, uint32_t worker, uint32_t step, const fray_input *input,
                        fray_output *output);

/* ---- read-only views, valid until the next tick ---- */

typedef struct {
  uint32_t rate_hz, substeps, iterations, lu_um;
  uint32_t particle_mass_ng;
  int32_t thickness;                /* of the cloth, Q24 lu */
  int32_t tear_min_q16, tear_max_q16;
  uint32_t tearing;                 /* 0: nothing ever tears */
  uint64_t tick;                    /* ticks computed so far */
  uint32_t physics_id;              /* of the library that wrote the image: fray_physics_id() */
  uint32_t springs[3], batches[3];  /* by fray_spring_kind */
  uint32_t bodies;
  uint32_t particles_max, contacts_max, tears_max;
  uint32_t splits_max;              /* split budget of a tick; 0: crossings never split */
  uint32_t all_yarn;                /* 1: every free crossing is split from tick 0 on */
  int32_t split_min_q16, split_max_q16; /* strain at which the ends of a spring split */
  int32_t disconnect_distance;      /* Q24 lu: yarns drawn farther apart are disconnected */
  uint32_t yarn_stiffness_un;       /* force of an elastic yarn at a strain of 1, uN; 0: projection */
  uint32_t yarn_steps, yarn_damping_ns; /* elastic steps of a substep; 0: no damping */
  int32_t gravity[3];               /* Q28 lu per substep, each substep: floor */
  uint32_t gravity_rest[3];         /* and 2^-32 of that unit */
  uint32_t triangles, triangles_max; /* of a membrane, in use and at most; 0: woven */
  uint32_t elastic_steps;           /* of a membrane, in a substep */
  int32_t stiffness_q30;            /* of a membrane: fraction of the measured stiffness, 1 << 30 is all */
  uint32_t corotational;            /* 1: a membrane that is isotropic; its strength has the same fraction */
  uint32_t self_pairs_max;          /* 0: no self-collision */
  int32_t self_thickness;           /* Q24 lu: distance that self-collision keeps */
  uint32_t hands;                   /* bit h: a body follows hand h */
  uint8_t consumed[FRAY_HANDS];     /* counter of the last pose consumed; 0 before the first */
} fray_info;

typedef struct {
  uint32_t count;              /* particles in use */
  uint32_t attached;           /* of these, the first `attached` are carried by bodies */
  const int32_t *x, *y, *z;    /* Q24 lu */
  const int32_t *vx, *vy, *vz; /* Q28 lu per substep */
} fray_particles;

/* The woven cloth. Crossing (warp i, weft j) has number j * warps + i. Structural springs are numbered along
 * wefts first, (i,j)-(i+1,j) is j * (warps - 1) + i; then along warps, (i,j)-(i,j+1) is
 * wefts * (warps - 1) + j * warps + i. All 0 for a membrane. */
typedef struct {
  uint32_t warps, wefts, weave_columns, weave_rows; /* the last two: the repeat of the weave, 1..8 each */
  uint64_t weave; /* bit (j % weave_rows) * 8 + (i % weave_columns): the warp is over the weft */
} fray_weave;

/* Cloth with yarns has two springs for every diagonal; the second is not alive until an end splits. */
typedef enum { FRAY_STRUCTURAL = 0, FRAY_BEND = 1, FRAY_SHEAR = 2 } fray_spring_kind;
typedef struct {
  uint32_t i, j;     /* particles */
  int32_t rest;      /* Q24 lu */
  uint32_t id;       /* canonical: see fray_weave; bend and shear springs follow (rt/state/yarn_grid.h) */
  uint8_t alive;     /* a broken spring keeps its ends */
  uint8_t attached;  /* at least one end is carried by a body */
  int32_t threshold; /* tear strain, Q16; structural springs only */
} fray_spring;

typedef enum {
  FRAY_ANCHOR = 0, /* no surface: particles are attached to it */
  FRAY_SPHERE = 1,
  FRAY_BOX = 2,
  FRAY_CAPSULE = 3, /* along its first axis */
  FRAY_PLANE = 4,
  FRAY_MESH = 5 /* fray_view_mesh() */
} fray_shape;
typedef enum { FRAY_FIXED = 0, FRAY_PATH = 1, FRAY_HAND = 2, FRAY_FREE = 3 } fray_motion;
typedef struct {
  fray_shape shape;
  fray_motion motion;  /* FRAY_HAND: also of a handle, fray_view_handle() */
  uint32_t hand;       /* of FRAY_HAND: 0 left, 1 right */
  int32_t radius;      /* Q24 lu: of a sphere, a capsule; 0 of other shapes */
  int32_t half[3];     /* Q24 lu: half sizes of a box; half[0] is a capsule's half length */
  int32_t axes[9];     /* Q30, rows are the body's axes; row 1 is a plane's normal */
  int32_t position[3]; /* Q24 lu */
  int32_t velocity[3]; /* Q28 lu per substep */
  int64_t impulse[3];  /* on the cloth in the last tick: Q28 lu per substep x particle mass */
} fray_body;

/* Triangles of a body of shape FRAY_MESH, constant: Q24 lu from the body's position; meshes do not turn.
 * Sharp points and edges cut. */
typedef struct {
  uint32_t points, edges, faces;
  const int32_t *point; /* 5 words each: x, y, z, sharp, one of its faces */
  const int32_t *edge;  /* 5 words: two points, two faces (the second -1 at a boundary), sharp */
  const int32_t *face;  /* 7 words: three points, anticlockwise from outside; unit normal, Q30;
                           bit k: it is the first face of its edge k */
} fray_mesh;

/* A handle: a body with mass that spring and damper draw to the proxy of its device. Energies: from START. */
typedef struct {
  uint32_t body;
  int32_t proxy[3];                /* Q24 lu */
  int64_t given_nj, given_most_nj; /* to the device, and the most that it was; below 0: it gave more */
  int64_t taken_nj;                /* by the passivity controller, which goes by the sum of both hands */
} fray_handle;

/* The yarns of a crossing (Metaaphanon 2009, section 3.3). A whole crossing is one particle; a split one
 * is a weft and a warp particle, each with half the mass. */
typedef enum {
  FRAY_WHOLE = 0, FRAY_CONNECTED = 1, /* split, held together: all-yarn cloth only */
  FRAY_LOOSE = 2,       /* the yarns slide along each other */
  FRAY_DISCONNECTED = 3 /* the yarns have come apart for good */
} fray_crossing_state;
typedef enum { FRAY_WEFT = 0, FRAY_WARP = 1 } fray_axis;

/* A triangle of a membrane: vertices are particles, anticlockwise at rest; edge k is opposite vertex k. */
typedef enum { FRAY_EDGE_INTACT = 0, FRAY_EDGE_TORN = 1, FRAY_EDGE_CUT = 2 } fray_edge;
typedef struct {
  uint32_t vertex[3];
  int32_t u[3], v[3];  /* Q24 lu: rest coordinates, along weft and warp */
  int32_t stress[3];   /* uu, vv, uv, Q12 N/m: now */
  uint8_t boundary[3]; /* 1: no triangle beyond that edge */
  uint8_t edge[3];     /* fray_edge: what made that boundary */
  uint8_t material;
} fray_triangle;

/* One pool of the memory plan. */
typedef struct {
  const char *name;
  uint32_t count;
  uint32_t element_bytes;
  uint32_t in_place; /* used from the image, no memory taken */
  uint32_t constant; /* never changes after the image was built */
} fray_pool;

/* Sizes, budgets and parameters. Cost: constant. */
fray_info fray_get_info(const fray_world *world);
/* Cost: constant. */
fray_particles fray_view_particles(const fray_world *world);
fray_weave fray_view_weave(const fray_world *world);
/* Woven worlds. spring < fray_get_info().springs[kind]. Cost: constant. */
fray_spring fray_view_spring(const fray_world *world, fray_spring_kind kind, uint32_t spring);
/* Woven worlds. crossing < warps x wefts. Cost: constant. */
fray_crossing_state fray_crossing_state_at(const fray_world *world, uint32_t crossing);
/* Its particle; of a split one that of the weft. Woven worlds; crossing < warps x wefts. Cost: constant. */
uint32_t fray_crossing_particle(const fray_world *world, uint32_t crossing);
/* The particle of a yarn at a crossing. Woven worlds; crossing < warps x wefts. Cost: constant. */
uint32_t fray_yarn_particle(const fray_world *world, uint32_t crossing, fray_axis axis);
/* The body that carries a particle. particle < fray_view_particles().attached. Cost: constant. */
uint32_t fray_attached_body(const fray_world *world, uint32_t particle);
/* body < fray_get_info().bodies. Cost: constant. */
fray_body fray_view_body(const fray_world *world, uint32_t body);
/* Returns 0 where the body is no mesh; *mesh is then empty. body < fray_get_info().bodies. Cost: linear in
 * the meshes of the world. */
int fray_view_mesh(const fray_world *world, uint32_t body, fray_mesh *mesh);
/* Returns 0 where the hand moves no handle; *handle is then untouched. hand < FRAY_HANDS. Cost: constant. */
int fray_view_handle(const fray_world *world, uint32_t hand, fray_handle *handle);
/* Membranes. triangle < fray_get_info().triangles. Cost: a few hundred instructions. */
fray_triangle fray_view_triangle(const fray_world *world, uint32_t triangle);
/* Returns 0 past the last pool; *pool is then untouched. index: any, from 0. Cost: linear in the pools. */
int fray_view_pool(const fray_world *world, uint32_t index, fray_pool *pool);

#ifdef __cplusplus
}
#endif
#endif
