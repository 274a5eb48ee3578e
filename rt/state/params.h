/* SPDX-License-Identifier: Apache-2.0 */
/* The scalars of a world: constants (params) and state, every one a 32-bit word with its range.
 * The loader checks the ranges; the stages rely on them. This is the image's order: within one major version
 * append only. */
#ifndef FRAY_STATE_PARAMS_H
#define FRAY_STATE_PARAMS_H

#include <stdint.h>

#include "rt/fray.h"

enum {
  MAX_PARTICLES = 1 << 20,
  MAX_SPRINGS = 1 << 22,
  MAX_BATCHES = 1 << 16,
  MAX_BODIES = 16,
  MAX_KEYS = 4096,
  MAX_CONTACTS = 1 << 20,
  MAX_BREAKS = 64,
  MAX_CLASSES = 32,
  MAX_SPLITS = 4096,
  MAX_MESH_POINTS = 1 << 15,
  MAX_MESH_FACES = 1 << 16,
  MAX_MESH_WORDS = 1 << 22,
  MAX_SUBSTEPS = 128,
  MAX_ITERATIONS = 128
};

#define WORD_MIN INT32_MIN
#define WORD_MAX INT32_MAX

/*    name              least       most */
#define PARAMS(X) \
  X(rate_hz,            1,          10000)     /* ticks a second */ \
  X(substeps,           1,          MAX_SUBSTEPS) \
  X(iterations,         1,          MAX_ITERATIONS) \
  X(warps,              0,          4096)      /* 0 of membranes, else 2 */ \
  X(wefts,              0,          4096) \
  X(lu_um,              1,          1000000) \
  X(particle_mass_ng,   1,          WORD_MAX) \
  X(attached,           0,          MAX_PARTICLES) \
  X(particles,          4,          MAX_PARTICLES) /* in use */ \
  X(links,              0,          MAX_SPRINGS)      /* structural rows come first */ \
  X(bends,              0,          MAX_SPRINGS)      /* then bend rows */ \
  X(shears,             0,          MAX_SPRINGS)      /* then shear rows */ \
  X(link_batches,       0,          MAX_BATCHES) \
  X(bend_batches,       0,          MAX_BATCHES) \
  X(shear_batches,      0,          MAX_BATCHES) \
  X(bodies,             0,          MAX_BODIES) \
  X(gravity_x,          -(1 << 24), 1 << 24)   /* Q28 lu per substep, each substep, floor */ \
  X(gravity_y,          -(1 << 24), 1 << 24) \
  X(gravity_z,          -(1 << 24), 1 << 24) \
  X(gravity_rest_x,     WORD_MIN,   WORD_MAX)  /* unsigned 2^-32 of that */ \
  X(gravity_rest_y,     WORD_MIN,   WORD_MAX) \
  X(gravity_rest_z,     WORD_MIN,   WORD_MAX) \
  X(drag,               0,          1 << 24)   /* Q24 of velocity lost each tick */ \
  X(relative_damping,   0,          1 << 24)   /* Q24 of non-rigid velocity lost each tick */ \
  X(thickness,          0,          1 << 24)   /* Q24 lu */ \
  X(tear_min,           0,          1 << 18)   /* Q16 strain */ \
  X(tear_max,           0,          1 << 18) \
  X(tearing,            0,          1) \
  X(tear_mirrored,      0,          1)         /* thresholds symmetric in the warps */ \
  X(seed,               WORD_MIN,   WORD_MAX) \
  X(tears_max,          1,          MAX_BREAKS) \
  X(weave_columns,      1,          8) \
  X(weave_rows,         1,          8) \
  X(weave_low,          WORD_MIN,   WORD_MAX) \
  X(weave_high,         WORD_MIN,   WORD_MAX) \
  X(hands,              0,          3)         /* bit h: a body follows hand h */ \
  X(pose_gain,          1,          WORD_MAX)  /* Q8 of Q24 lu for one pose step of 2 um */ \
  X(hand_speed,         1,          1 << 28)   /* Q24 lu a tick */ \
  X(force_gain,         1,          1 << 23)   /* impulse to 0.5 mN steps, see haptics/haptic_force.c */ \
  X(force_shift,        1,          62) \
  X(force_clamp,        0,          32767)     /* 0.5 mN */ \
  X(force_rate,         1,          32767)     /* 0.5 mN a tick */ \
  X(ramp_ticks,         1,          10000) \
  X(fade_ticks,         1,          10000) \
  X(stale_ticks,        1,          1000) \
  X(arm_poses,          1,          1000) \
  X(contact_margin,     0,          1 << 26)   /* Q24 lu */

typedef struct {
#define X(name, least, most) int32_t name;
  PARAMS(X)
#undef X
} params;

/*    name              least       most */
#define STATE(X) \
  X(tick_low,           WORD_MIN,   WORD_MAX)  /* ticks computed, a number of 64 bits */ \
  X(tick_high,          WORD_MIN,   WORD_MAX) \
  X(topology_low,       WORD_MIN,   WORD_MAX)  /* XOR of hash_entry over dead rows */ \
  X(topology_high,      WORD_MIN,   WORD_MAX) \
  X(tears_total,        0,          WORD_MAX)  /* saturates */ \
  X(faults,             0,          FRAY_FAULTS_ALL) \
  X(hash_low,           WORD_MIN,   WORD_MAX)  /* what the last tick reported; not hashed */ \
  X(hash_high,          WORD_MIN,   WORD_MAX) \
  X(gravity_phase_x,    WORD_MIN,   WORD_MAX)  /* running remainder of gravity_rest */ \
  X(gravity_phase_y,    WORD_MIN,   WORD_MAX) \
  X(gravity_phase_z,    WORD_MIN,   WORD_MAX) \
  X(mode,               FRAY_READY, FRAY_SAFE) \
  X(starting,           0,          1)         /* START taken, hands not armed yet */ \
  X(muted,              0,          1)         /* ZERO: forces stay at zero */ \
  X(ramp,               0,          1 << 16)   /* Q16 share of the force that is let out */ \
  HAND_STATE(X, 0) HAND_STATE(X, 1)

#define HAND_STATE(X, h) \
  X(good_##h,           0,          WORD_MAX)  /* ticks in a row with a pose */ \
  X(missing_##h,        0,          WORD_MAX)  /* ticks in a row without one */ \
  X(consumed_##h,       0,          15) \
  X(buttons_##h,        0,          15) \
  X(pose_x_##h,         -32768,     32767)     /* the last pose, device steps */ \
  X(pose_y_##h,         -32768,     32767) \
  X(pose_z_##h,         -32768,     32767) \
  X(datum_x_##h,        -(1 << 17), 1 << 17)     /* the pose that means "at home" */ \
  X(datum_y_##h,        -(1 << 17), 1 << 17) \
  X(datum_z_##h,        -(1 << 17), 1 << 17) \
  X(sent_x_##h,         -32767,     32767)     /* the last force sent */ \
  X(sent_y_##h,         -32767,     32767) \
  X(sent_z_##h,         -32767,     32767)

/* One hand's words as they stand in the state, so that code can loop over hands. */
typedef struct {
  int32_t good, missing, consumed, buttons;
  int32_t pose[3], datum[3], sent[3];
} hand_state;

typedef struct {
  int32_t tick[2];
  int32_t topology[2];
  int32_t tears_total, faults;
  int32_t hash[2];
  int32_t gravity_phase[3];
  int32_t mode, starting, muted, ramp;
  hand_state hand[FRAY_HANDS];
} state;

/* Two of its words, a number of 64 bits. */
static inline uint64_t state_pair(const int32_t words[2]) {
  return (uint64_t)(uint32_t)words[1] << 32 | (uint32_t)words[0];
}

static inline void state_set_pair(int32_t words[2], uint64_t value) {
  words[0] = (int32_t)(uint32_t)(value & UINT32_MAX);
  words[1] = (int32_t)(uint32_t)(value >> 32);
}

/* Ticks computed so far, which is the number of the next one. */
static inline uint64_t state_tick(const state *s) { return state_pair(s->tick); }

/* Of worlds with yarns only.
 *    name              least       most */
#define YARN_PARAMS(X) \
  X(split_min,          0,          1 << 18)   /* Q16 strain, below tear_min */ \
  X(split_max,          0,          1 << 18)   /* below tear_max */ \
  X(disconnect_distance, 1,          1 << 26)   /* Q24 lu: farther apart a split crossing is disconnected */ \
  X(disconnect_by_particles, 0,          1)         /* measured between its particles, not its yarns */ \
  X(spread_splits,      0,          1)         /* beside one that disconnects, to the opposite weave */ \
  X(slip_friction,      0,          16 << 16)  /* Q16 */ \
  X(static_friction,    1 << 16,    4 << 16)   /* Q16: at rest, over sliding */ \
  X(crossing_friction,  0,          1 << 24)   /* Q24 lu: what friction holds in a substep without
                                                  being pressed */ \
  X(all_yarn,           0,          1)         /* every free crossing is split from tick 0 on */

typedef struct {
#define X(name, least, most) int32_t name;
  YARN_PARAMS(X)
#undef X
} yarn_params;

#define YARN_STATE(X) \
  X(split,              0,          MAX_PARTICLES) /* spare particles in use */ \
  X(pending,            0,          MAX_PARTICLES) /* crossings that wait to be split */ \
  X(connected,          0,          MAX_PARTICLES) /* couples by state */ \
  X(loose,              0,          MAX_PARTICLES) \
  X(disconnected,       0,          MAX_PARTICLES)

typedef struct {
#define X(name, least, most) int32_t name;
  YARN_STATE(X)
#undef X
} yarn_state;

/* Of worlds whose yarns have a stiffness only.
 *    name              least       most */
#define YARN_ELASTIC_PARAMS(X) \
  X(steps_bits,         0,          6)         /* 2^ of it: inner steps in a substep */ \
  X(stiffness_un,       1,          WORD_MAX)  /* force of a yarn at a strain of 1, uN */ \
  X(damping_ns,         0,          WORD_MAX)  /* force is that of strain + damping * its rate */

typedef struct {
#define X(name, least, most) int32_t name;
  YARN_ELASTIC_PARAMS(X)
#undef X
} yarn_elastic_params;

enum {
#define X(name, least, most) +1
  YARN_ELASTIC_PARAM_WORDS = 0 YARN_ELASTIC_PARAMS(X),
  PARAM_WORDS = 0 PARAMS(X),
  STATE_WORDS = 0 STATE(X),
  YARN_PARAM_WORDS = 0 YARN_PARAMS(X),
  YARN_STATE_WORDS = 0 YARN_STATE(X)
#undef X
};
_Static_assert(sizeof(params) == 4u * PARAM_WORDS, "params is a table of words");
_Static_assert(sizeof(state) == 4u * STATE_WORDS, "state is a table of words");

#endif
