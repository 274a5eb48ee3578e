/* SPDX-License-Identifier: Apache-2.0 */
/* Springs: all that connects two particles, of three kinds stored one after the other: structural links,
 * bend springs, shear springs. Springs of a batch share no particle.
 * A spring keeps its index for ever; breaking it sets its kind to SPRING_DEAD. */
#ifndef FRAY_STATE_SPRING_H
#define FRAY_STATE_SPRING_H

#include <stdint.h>

#include "rt/base/fx.h"

/* The type of indices of springs, particles, vertices, triangles: 32 bits on hosts, 16 where memory is
 * short. The hashes are the same. */
#ifndef FRAY_ID_BITS
#define FRAY_ID_BITS 32
#endif
#if FRAY_ID_BITS == 16
typedef uint16_t index_t;
#else
typedef uint32_t index_t;
#endif

/* The kind byte of a spring: 0, or its class; and, where an end is one of the two yarns of a split crossing
 * and has half its mass, SPRING_HALF_MASS with SPRING_HALF_I, SPRING_HALF_J or both. */
enum { SPRING_DEAD = 0, SPRING_CLASS = 31, SPRING_HALF_J = 32, SPRING_HALF_I = 64, SPRING_HALF_MASS = 128 };

/* Classes as the scene compiler numbers them; crossing_spring_kind() relies on it. */
enum {
  CLASS_WEFT = 1, /* links and bend springs along wefts */
  CLASS_WARP = 2,
  CLASS_SHEAR = 3,
  CLASS_SHEAR_HALF = 4 /* one of the two springs of a diagonal with a split end */
};

/* Link directions are in units of 2^LINK_SHIFT position steps. */
enum { LINK_SHIFT = 8, LINK_UNITS_MIN = 1024, LINK_UNITS_MAX = 8191 };

/* A class of structural links, 1..CLASS_WARP; class 0 is that of dead springs. R is the rest length in these
 * units, LINK_UNITS_MIN..MAX. */
typedef struct {
  int32_t rest;    /* Q24 lu */
  int32_t r2;      /* R^2, rounded once, from the unrounded rest length */
  int32_t n_max;   /* R^2 * 25/16: longer links are treated as 25% too long */
  int32_t inverse; /* 2^36 / R^2 */
  int32_t push;    /* Q12, 0..4096: fraction of a projection that a compressed link gets */
} link_class;

/* rest: Q24 lu, below 2^21. */
static inline link_class link_class_make(int32_t rest, int32_t push) {
  const int64_t r2 = fx_round64(fx_mul_wide(rest, rest), 2 * LINK_SHIFT);
  const link_class c = {rest, (int32_t)r2, (int32_t)(r2 + r2 / 16 * 9),
                        (int32_t)(((int64_t)1 << 36) / (r2 > 0 ? r2 : 1)), push};
  return c;
}

/* Worlds with a shear lock have two classes more, of diagonals that get no shorter than R: CLASS_LOCK for
 * CLASS_SHEAR, the next for CLASS_SHEAR_HALF. What is longer counts as R, so nothing pulls. */
enum { CLASS_LOCK = CLASS_WARP + 1, CLASSES_WITH_LOCK = CLASS_LOCK + 2, LOCK_UNITS_MIN = 128 };
/* rest: Q24 lu, LOCK_UNITS_MIN to LINK_UNITS_MAX in units of 2^LINK_SHIFT. */
static inline link_class link_class_of_lock(int32_t rest) {
  link_class c = link_class_make(rest, 4096);
  c.n_max = c.r2;
  return c;
}

/* A class of bend or shear springs: dv = gain * elongation, along the spring, for one tick, of elastic yarns
 * one substep, in (lu per substep) per lu; gain = mantissa * 2^-shift, below 1/2. Directions are in units of
 * 2^down position steps, of which the rest length R is BEND_SHEAR_UNITS_MIN..MAX. */
enum { BEND_SHEAR_UNITS_MIN = 4096, BEND_SHEAR_UNITS_MAX = 8191 };
enum { BEND_SHEAR_REST_MIN = 1 << 13, BEND_SHEAR_REST_MAX = 1 << 22 };
typedef struct {
  int32_t rest;     /* Q24 lu */
  int32_t mantissa; /* 0, or 2^15..2^16-1 */
  int32_t shift;    /* 17..46 */
  int32_t compression_only;
  int32_t down;     /* 1..10 */
  int32_t r2;       /* R^2 */
  int32_t inactive_r2; /* |d|^2 from which on it has no force: R^2 less the largest rounding error */
  int32_t inverse;  /* 2^39 / R^2 */
  int32_t gain;     /* the mantissa in 14 bits */
  int32_t scale;    /* 1..30: dv is the product of direction and pull, rounded, >> scale */
} bend_shear_class;

/* The other fields, from the first four. rest: BEND_SHEAR_REST_MIN..MAX. */
static inline bend_shear_class bend_shear_class_make(int32_t rest, int32_t mantissa, int32_t shift,
                                                     int32_t compression_only) {
  int32_t down = 1;
  int32_t r = fx_round(rest, 1);
  while (r > BEND_SHEAR_UNITS_MAX) r = fx_round(rest, (unsigned)++down);
  const int32_t scale = shift - down - 6;
  const int fits = scale <= 30; /* else the gain is too small to move anything */
  const bend_shear_class c = {rest, fits ? mantissa : 0, shift, compression_only, down, r * r,
                              compression_only != 0 ? r * r - 3 * r : INT32_MAX,
                              (int32_t)(((int64_t)1 << 39) / ((int64_t)r * r)),
                              fits ? fx_asr(mantissa, 2) : 0, fits ? scale : 30};
  return c;
}

/* 1 - 1/sqrt(1 + x), as forces have it, with the square of a length over that at rest, less 1: of bend and
 * shear springs on -1/2..1, in powers of x from the first, Q14; of elastic yarns on -7/16..9/16, over x, in
 * powers of x, Q28. */
enum {
  BEND_SHEAR_SERIES_1 = 8192,
  BEND_SHEAR_SERIES_2 = -6780,
  BEND_SHEAR_SERIES_3 = 6059,
  BEND_SHEAR_SERIES_4 = -2706,
  STRETCH_PHI_0 = 1 << 27,
  STRETCH_PHI_1 = -101005220,
  STRETCH_PHI_2 = 88514470,
  STRETCH_PHI_3 = -82736220,
  STRETCH_PHI_4 = 47846700
};

/* Which ends of a batch's springs are attached: none, i, or both. Springs of inactive batches have no force
 * and are not projected, but links among them can break. */
enum { BATCH_FREE = 0, BATCH_ATTACHED = 1, BATCH_INACTIVE = 2 };
typedef struct {
  int32_t first; /* spring */
  int32_t count;
  int32_t attached; /* BATCH_FREE, BATCH_ATTACHED or BATCH_INACTIVE */
} spring_batch;

/* rest * (1 + strain), Q24 lu. A rest length is below 1/8 lu, a strain at most 4. */
static inline uint32_t link_stretched(int32_t rest, int32_t strain_q16) {
#if FX_NO_LONG_MULTIPLY
  const uint32_t r = (uint32_t)rest;
  const uint32_t s = (uint32_t)strain_q16;
  const uint32_t low = (r & 0xFFFFu) * (s & 0xFFFFu) >> 16;
  return r + r * (s >> 16) + (r >> 16) * (s & 0xFFFFu) + low;
#else
  return (uint32_t)(fx_mul_wide_u((uint32_t)rest, 65536u + (uint32_t)strain_q16) >> 16);
#endif
}
/* Its square. */
static inline uint64_t link_stretched_squared(int32_t rest, int32_t strain_q16) {
  return fx_square((int32_t)link_stretched(rest, strain_q16));
}

enum {
  LINK_CLASS_WORDS = sizeof(link_class) / 4,
  BEND_SHEAR_CLASS_WORDS = sizeof(bend_shear_class) / 4,
  BATCH_WORDS = sizeof(spring_batch) / 4
};

#endif
