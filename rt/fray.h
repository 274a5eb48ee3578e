/* SPDX-License-Identifier: Apache-2.0 */
/* fray: cloth that stretches and tears, in fixed point, one pure tick at a time.
 *
 * This is the whole public interface of the runtime. Nothing in it allocates, reads a clock,
 * does I/O or keeps a global: a world lives in memory that the caller owns, and a tick maps
 * (world, input) to (world, output). The same image and the same inputs give the same hash
 * after every tick on every machine.
 *
 * Threads: one world belongs to one thread or interrupt level at a time; worlds are
 * independent. Views are valid until the next tick.
 *
 * Units: lengths are in lu ("length units", params.lu_um micrometres each), Q24: the integer
 * 1 << 24 is one lu. Velocities are Q28 lu per substep. Forces on the bus are 0.5 mN a step.
 */
#ifndef FRAY_H
#define FRAY_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FRAY_VERSION "0.3.0"
#define FRAY_IMAGE_MAJOR 2u
#define FRAY_IMAGE_MINOR 7u

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
  FRAY_BAD_BATCH,    /* two rows of one batch share a particle, or the batches have gaps */
  FRAY_SMALL_MEMORY  /* the caller's memory is smaller than fray_bytes() says */
} fray_status;

/* Where an image was refused. `what` is a constant string: what was expected there. */
typedef struct {
  fray_status status;
  uint32_t section; /* section id, 0 for the header */
  uint32_t index;   /* element in the section */
  const char *what;
} fray_error;

enum { FRAY_ALIGN = 16 };

/* Bytes of memory that fray_open() needs for this image.
 * Errors: as fray_open(), from the header alone. Cost: constant. */
fray_status fray_bytes(const void *image, size_t image_bytes, size_t *bytes, fray_error *error);

/* Validates an image and builds its world in the caller's memory.
 * `image` must outlive the world: its constants are used in place where byte order, index width
 * and alignment allow. `memory` is aligned to FRAY_ALIGN.
 * On any status but FRAY_OK, *world is NULL and *error says where (error may be NULL).
 * Cost: linear in the image's length; never more, whatever the image holds. */
fray_status fray_open(const void *image, size_t image_bytes, void *memory, size_t memory_bytes,
                      fray_world **world, fray_error *error);

/* The code that runs the hot loops: the same bits, other speeds. A world begins with SCALAR. */
typedef enum {
  FRAY_KERNEL_SCALAR = 0,
  FRAY_KERNEL_AVX2 = 1,
  FRAY_KERNEL_AVX512 = 2, /* F, BW, DQ, VL */
  FRAY_KERNEL_NEON = 3,
  FRAY_KERNEL_HELIUM = 4
} fray_kernel;
/* Returns 1, or 0 where this build lacks the kernel (the world keeps the one that it has). That the
 * machine has its instructions is for the caller to know; platform/linux/cpu.h asks. */
int fray_use(fray_world *world, fray_kernel kernel);

/* What the world was told for one tick: at most one pose a hand and one command.
 * Poses are 2 um a step from the device's origin; `counter` is the frame's 4-bit counter. */
typedef struct {
  int16_t x, y, z;
  uint8_t counter; /* 0..15 */
  uint8_t buttons; /* 0..15 */
} fray_pose;

typedef enum {
  FRAY_VERB_NONE = 0,
  FRAY_VERB_START, /* READY -> OPERATIONAL as soon as every hand has sent enough good poses */
  FRAY_VERB_STOP,  /* OPERATIONAL -> READY; forces fade out; withdraws a START that waits */
  FRAY_VERB_RESET, /* SAFE -> READY; clears the sticky faults */
  FRAY_VERB_ZERO,  /* OPERATIONAL: forces fade to zero and stay there until the next START */
  FRAY_VERB_HALT   /* any state -> SAFE, force zero at once; said by the runtime on a lost bus */
} fray_verb;

typedef struct {
  uint8_t has_pose; /* bit h: pose[h] arrived for this tick */
  fray_pose pose[FRAY_HANDS];
  uint8_t verb; /* fray_verb */
  uint8_t verb_counter;
} fray_input;

typedef enum { FRAY_READY = 1, FRAY_OPERATIONAL = 2, FRAY_SAFE = 3 } fray_state;

/* Sticky fault bits; cleared by FRAY_VERB_RESET, which applies in SAFE only (HALT leads there). */
enum {
  FRAY_FAULT_STALE_LEFT = 1u << 0,
  FRAY_FAULT_STALE_RIGHT = 1u << 1,
  FRAY_FAULT_CONTACTS_FULL = 1u << 2, /* raise `limits contacts` */
  FRAY_FAULT_CUTS_WAIT = 1u << 3,     /* more springs over their threshold than `cuts_per_tick` */
  FRAY_FAULT_LEFT_WORLD = 1u << 4,    /* something was held back at the edge of the world */
  FRAY_FAULT_HALTED = 1u << 5,        /* HALT: the bus was lost, or an operator said so */
  FRAY_FAULT_SPARES_FULL = 1u << 6,   /* a crossing stays whole: raise `limits spare_particles` */
  FRAY_FAULT_SPLITS_WAIT = 1u << 7,   /* more crossings split or come apart than `splits_per_tick` */
  FRAY_FAULT_SELVES = 1u << 8,        /* yarns or triangles moved as one, for which the work is bounded too low:
                                         raise `limits self_pairs` */
  FRAY_FAULT_JAMMED = 1u << 9,        /* what is between bodies has no place, or nothing kept it apart */
  FRAY_FAULT_CROWDED = 1u << 10,       /* something stood still: more of a mesh near its way than it is
                                          held against */
  FRAY_FAULT_TRIANGLES_FULL = 1u << 11 /* a sheet does not tear or is not cut: raise `limits
                                           spare_triangles` */
};

typedef enum {
  FRAY_RESULT_OK = 0,
  FRAY_RESULT_REFUSED = 1, /* the verb does not apply in this state */
  FRAY_RESULT_UNKNOWN = 2  /* no such verb */
} fray_result;

/* Counted work of one tick. */
typedef struct {
  uint32_t predictions; /* particles x substeps */
  uint32_t projections; /* structural rows x sweeps x substeps */
  uint32_t springs;     /* bend and shear rows */
  uint32_t contacts;    /* candidate contacts x substeps */
  uint32_t tear_tests;  /* structural rows */
  uint32_t cuts;        /* structural springs cut */
  uint32_t gathers;     /* free particles x bodies with a surface, compared with a body's reach */
  uint32_t over;        /* structural springs found over their thresholds */
  uint32_t transitions; /* structural rows tested for splitting, couples for coming apart */
  uint32_t splits;      /* crossings split or loosened */
  uint32_t slips;       /* connected and loose couples x substeps */
  uint32_t stretches;   /* structural rows x inner steps x substeps, twice with damping */
  uint32_t lines;       /* along which a triangle sheet was tried for tearing */
  uint32_t pulls;       /* triangles x inner steps x substeps */
  uint32_t folds;       /* sides of two triangles, each time they are bent */
  uint32_t mesh_tests;  /* ways of particles held against the box of a mesh, or ball */
  uint32_t mesh_boxes;  /* boxes of meshes that a way was held against */
  uint32_t mesh_sweeps; /* of particles and a mesh's triangle, triangles and its points, sides and its edges */
  uint32_t mesh_stops;  /* particles put back to where the substep began */
  uint32_t self_visits; /* parts of a sheet held against each other for what may meet. Of triangles a list is
                           kept from tick to tick, so it, and sweeps, differ behind fray_open() */
  uint32_t self_pairs;  /* of segments of yarns, found; of vertices and triangles, and of sides, that may meet */
  uint32_t self_sweeps; /* of these, each time they are held against each other */
  uint32_t self_stops;  /* particles that moved as one with what they met, each time */
  uint32_t slashes;     /* of the cuts, those that blades made in a triangle sheet */
} fray_work;

typedef struct {
  uint32_t tick;                /* the tick that was just computed, from 0 */
  uint64_t hash;                /* of the state after it */
  int16_t force[FRAY_HANDS][3]; /* 0.5 mN a step, after ramp, rate limit and clamp */
  int32_t raw[FRAY_HANDS][3];   /* 0.5 mN a step, before them */
  uint8_t consumed[FRAY_HANDS]; /* counter of the last pose consumed; 0 before the first */
  uint8_t state;                /* fray_state */
  uint8_t acked;                /* the verb that was answered in this tick, or 0 */
  uint8_t ack_counter;
  uint8_t result; /* fray_result of the acked verb */
  uint16_t faults;
  uint32_t cuts_waiting; /* springs over their threshold that the cap left for the next tick */
  uint32_t cut_first;    /* structural spring (canonical id) cut first in this tick, or the vertex where a
                            triangle sheet tore; see cuts */
  uint32_t cuts_total;
  uint32_t splits_waiting;       /* crossings that the cap left for the next tick */
  uint32_t couples_connected, couples_loose, couples_disconnected; /* of the whole sheet */
  fray_work work;
} fray_output;

/* Advances the world by one tick. Never fails: what does not fit a pool is left out in a
 * defined order and reported in output->faults.
 * Cost: bounded by the image (see fray_limits); independent of the clock. */
void fray_tick(fray_world *world, const fray_input *input, fray_output *output);

/* The hash that the last tick reported (at open: the hash of the state in the image). */
uint64_t fray_hash(const fray_world *world);

/* Saves the world as an image: bytes needed, and the save itself.
 * Returns the bytes written, or 0 iff the buffer is smaller than fray_save_bytes(). */
size_t fray_save_bytes(const fray_world *world);
size_t fray_save(const fray_world *world, void *buffer, size_t buffer_bytes);

/* The most work that one tick of this world can count. */
fray_work fray_limits(const fray_world *world);

/* ---- one tick by several workers ----
 *
 * A share divides the ticks of one world into steps, in a fixed way, for a fixed number of workers.
 * They compute what fray_tick() computes, to the last bit, whatever their number. The runtime has no
 * threads of its own: the caller gives each worker one, and in every tick worker w takes steps 0, 1,
 * ... fray_share_steps() - 1 of its own, each as soon as what it needs is there.
 *
 *   for (uint32_t n = 0; n < fray_share_steps(share); ++n) {
 *     wait until (fray_share_need(share, w, n));          what the needed worker wrote is visible here
 *     fray_share_step(share, w, n, &input, &output);
 *     tell the others that worker w has done n + 1 steps;
 *   }
 *
 * platform/linux/team.h does this with threads. Between ticks the world is as after fray_tick(): it
 * can be saved, viewed, or stepped by fray_tick(). */
enum { FRAY_WORKERS_MAX = 16, FRAY_EVERYONE = FRAY_WORKERS_MAX, FRAY_SHARE_ALIGN = 64 };

typedef struct fray_share fray_share;

/* How many steps of which worker, or of FRAY_EVERYONE, must have been done in this tick. 0: none. */
typedef struct {
  uint32_t worker;
  uint32_t steps;
} fray_need;

/* How many of so many workers are of use to this world: 1 where it is too small to be divided, or
 * its rows leave no place to cut. Cost: constant. */
uint32_t fray_share_useful(const fray_world *world, uint32_t workers_max);

/* Bytes of memory that a share of 1 to FRAY_WORKERS_MAX workers needs. Cost: constant. */
size_t fray_share_bytes(const fray_world *world, uint32_t workers);

/* Plans the steps in the caller's memory, aligned to FRAY_SHARE_ALIGN. NULL iff the number of workers
 * is out of range or the memory too small or not aligned. Memory and world stay the caller's and must
 * outlive the share. Cost: linear in the structural rows. */
fray_share *fray_share_open(fray_world *world, uint32_t workers, void *memory, size_t memory_bytes);

/* 1 iff the rows still are as they were planned. Rows that die keep the plan; where rows get other
 * ends, open the share again. Cost: linear in the structural rows. */
int fray_share_holds(const fray_share *share);

/* The same for all workers. */
uint32_t fray_share_steps(const fray_share *share);
/* step 0..steps-1. Cost: constant. */
fray_need fray_share_need(const fray_share *share, uint32_t worker, uint32_t step);
/* Only worker 0 looks at input and output. Cost of a tick's steps, all workers together: that of
 * fray_tick(), and a few hundred instructions a step. */
void fray_share_step(fray_share *share, uint32_t worker, uint32_t step, const fray_input *input,
                     fray_output *output);

/* ---- read-only views, valid until the next tick ---- */

typedef struct {
  uint32_t count;          /* particles in use */
  uint32_t held;           /* of these, the first `held` are carried by bodies */
  const int32_t *x, *y, *z;    /* Q24 lu */
  const int32_t *vx, *vy, *vz; /* Q28 lu per substep */
} fray_particles;

/* Rows of one family. A dead row keeps its ends. Ends by fray_row(). */
/* Sheets with yarns have two rows for every diagonal; the second one is dead until an end splits. */
typedef enum { FRAY_STRUCTURAL = 0, FRAY_BEND = 1, FRAY_SHEAR = 2 } fray_family;
typedef struct {
  uint32_t i, j;     /* particles */
  int32_t rest;      /* Q24 lu */
  uint32_t home;     /* canonical id in the weave: see fray_sheet for structural rows; bend and
                        shear rows are numbered on behind them (rt/model/weave.h) */
  uint8_t alive;
  uint8_t held;      /* at least one end is carried by a body */
  int32_t threshold; /* Q16 strain at which it is cut; structural rows only */
} fray_row;

/* The woven sheet. Crossing (warp i, weft j) is number j * warps + i. Structural springs are
 * numbered: along wefts first, (i,j)-(i+1,j) is j * (warps - 1) + i; then along warps,
 * (i,j)-(i,j+1) is wefts * (warps - 1) + j * warps + i. */
typedef struct {
  uint32_t warps, wefts;
  uint32_t weave_columns, weave_rows; /* the repeat of the weave, 1..8 each */
  uint64_t weave; /* bit (j % rows) * 8 + (i % columns): the warp is over the weft */
} fray_sheet;

typedef enum {
  FRAY_ANCHOR = 0, /* has no surface: it only holds crossings where they are */
  FRAY_BALL = 1,
  FRAY_BOX = 2,
  FRAY_BAR = 3, /* a capsule along its first axis */
  FRAY_PLANE = 4,
  FRAY_MESH = 5 /* see fray_view_mesh */
} fray_shape;
typedef enum { FRAY_FIXED = 0, FRAY_PATH = 1, FRAY_HAND = 2, FRAY_FREE = 3 } fray_motion;
typedef struct {
  fray_shape shape;
  fray_motion motion;
  uint32_t hand;            /* for FRAY_HAND: 0 left, 1 right */
  int32_t radius;           /* Q24 lu: ball, bar (capsule) */
  int32_t half[3];          /* Q24 lu: box half sizes; bar: half[0] is its half length */
  int32_t axes[9];          /* Q30, rows are the body's axes; plane: row 1 is its normal */
  int32_t position[3];      /* Q24 lu */
  int32_t velocity[3];      /* Q28 lu per substep */
  int64_t impulse[3];       /* what the cloth gained from it in the last tick: Q28 lu per substep,
                               in particle masses */
} fray_body;

typedef struct {
  uint32_t rate_hz, substeps, sweeps, lu_um;
  uint32_t particle_mass_ng;
  int32_t thickness;               /* Q24 lu */
  int32_t tear_min_q16, tear_max_q16;
  uint32_t tearing;                /* 0: springs are never cut */
  uint32_t tick;                   /* ticks computed so far */
  uint32_t rows[3];                /* by family */
  uint32_t batches[3];
  uint32_t bodies;
  uint32_t particles_max, contacts_max, cuts_max;
  uint32_t splits_max;             /* a tick; 0: a sheet without yarns, whose crossings never split */
  uint32_t all_yarn;               /* every free crossing is a couple from tick 0 on */
  int32_t transition_min_q16, transition_max_q16; /* strain that splits a spring's ends */
  int32_t loose_max;               /* Q24 lu: farther apart a couple is disconnected */
  uint32_t stretch_un;             /* force of a yarn, uN, at a strain of 1; 0: projection holds it */
  uint32_t stretch_steps;          /* inner steps of a substep */
  uint32_t stretch_damping_ns;
  int32_t stretch_limit_q16;       /* strain from which on projection holds it */
  int32_t gravity[3];              /* Q28 lu per substep, per substep: whole part (floor) */
  uint32_t gravity_rest[3];        /* 2^-32 of that unit */
  uint32_t triangles, triangles_max; /* in use; 0: a woven sheet */
  uint32_t inner_steps;            /* of a triangle sheet's stress in a substep */
  int32_t stiffness_q30;           /* of it: share of the measured stiffness, 1 << 30 is all */
  uint32_t pairs_max;              /* segments of yarns that may meet in a tick, or parts of triangles near each
                                      other; 0: no self-collision */
  int32_t self_thickness;          /* Q24 lu: what meets is kept so far apart */
  uint32_t hands;                  /* bit h: a body follows hand h */
  uint8_t consumed[FRAY_HANDS];    /* counter of the last pose consumed; 0 before the first */
} fray_facts;

fray_facts fray_describe(const fray_world *world);
fray_particles fray_view_particles(const fray_world *world);
fray_sheet fray_view_sheet(const fray_world *world);
fray_row fray_view_row(const fray_world *world, fray_family family, uint32_t row);
fray_body fray_view_body(const fray_world *world, uint32_t body);

/* The triangles of a body of shape FRAY_MESH, constant. Places are Q24 lu from the body's position;
 * meshes do not turn. Sharp points and edges are those that cut. */
typedef struct {
  uint32_t points, edges, faces;
  const int32_t *point; /* 5 words each: x, y, z, sharp, one of its faces */
  const int32_t *edge;  /* 5 words: two points, two faces (the second -1 at a border), sharp */
  const int32_t *face;  /* 7 words: three points, anticlockwise from outside; the normal, Q30; of which of
                           its sides it is an edge's first face, a bit each */
} fray_mesh;
/* Returns 0 where the body is no mesh; *mesh is then empty. */
int fray_view_mesh(const fray_world *world, uint32_t body, fray_mesh *mesh);
uint32_t fray_particle_at(const fray_world *world, uint32_t crossing);

/* The yarns of a crossing (Metaaphanon 2009, section 3.3). A whole crossing is one particle of the
 * base cloth; any other is a couple of a weft and a warp particle, each with half the mass. */
typedef enum {
  FRAY_WHOLE = 0,
  FRAY_CONNECTED = 1,   /* held together: all-yarn sheets only */
  FRAY_LOOSE = 2,       /* the yarns slide over each other */
  FRAY_DISCONNECTED = 3 /* the yarns have come apart for good */
} fray_couple;
typedef enum { FRAY_WEFT = 0, FRAY_WARP = 1 } fray_axis;
fray_couple fray_couple_at(const fray_world *world, uint32_t crossing);
/* The particle that the yarn has there: of whole crossings the one of fray_particle_at, which is also
 * the weft's afterwards. */
uint32_t fray_particle_of(const fray_world *world, uint32_t crossing, fray_axis axis);
/* The body that carries a held particle (particle < held). */
uint32_t fray_holder(const fray_world *world, uint32_t particle);

/* A triangle of a triangle sheet, from 0 to fray_describe().triangles - 1: its vertices are particles,
 * anticlockwise in rest coordinates; side k is opposite vertex k. */
typedef enum { FRAY_SIDE_WHOLE = 0, FRAY_SIDE_TORN = 1, FRAY_SIDE_CUT = 2 } fray_side;
typedef struct {
  uint32_t vertex[3];
  int32_t u[3], v[3];      /* Q24 lu: rest coordinates, along weft and warp */
  int32_t stress[3];       /* uu, vv, uv, Q12 N/m: now */
  uint8_t border[3];       /* no triangle beyond that side */
  uint8_t side[3];         /* fray_side: what made that border */
  uint8_t cloth;
} fray_triangle;
fray_triangle fray_view_triangle(const fray_world *world, uint32_t triangle);

/* One pool of the memory plan: `index` from 0; returns 0 past the last. */
typedef struct {
  const char *name;
  uint32_t count;
  uint32_t element_bytes;
  uint32_t in_place; /* used from the image, no memory taken */
  uint32_t constant; /* never changes after the image was built */
} fray_pool;
int fray_view_pool(const fray_world *world, uint32_t index, fray_pool *pool);

#ifdef __cplusplus
}
#endif
#endif
