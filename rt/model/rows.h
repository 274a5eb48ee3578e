/* SPDX-License-Identifier: Apache-2.0 */
/* Rows: everything that couples two particles, in three families laid one after the other:
 * structural links, bend springs, shear springs. Rows of a batch share no particle.
 * A row keeps its place for life; cutting it sets its class to ROW_DEAD. */
#ifndef FRAY_MODEL_ROWS_H
#define FRAY_MODEL_ROWS_H

#include <stdint.h>

#include "rt/base/fx.h"

/* Index width: 32 bits on hosts, 16 where memory is short. The hashes are the same. */
#ifndef FRAY_ID_BITS
#define FRAY_ID_BITS 32
#endif
#if FRAY_ID_BITS == 16
typedef uint16_t row_id;
#else
typedef uint32_t row_id;
#endif

/* A row's kind: 0, or its class, with ROW_LIGHT and one or both of the others where an end weighs half
 * as much as a crossing, being one of its two yarns. */
enum { ROW_DEAD = 0, ROW_CLASS = 31, ROW_UP_J = 32, ROW_UP_I = 64, ROW_LIGHT = 128 };

/* Classes as the scene compiler numbers them; what splits rows relies on it. A yarn that goes from one
 * side of the cloth to the other has a longer way than the cloth: CLASS_CRIMP once for a half of the
 * thickness between the ends of a link, twice for all of it. */
enum {
  CLASS_WEFT = 1, /* links and bend springs along wefts */
  CLASS_WARP = 2,
  CLASS_CRIMP = 2,
  CLASS_LINKS = CLASS_WARP + 2 * CLASS_CRIMP, /* the last of links */
  CLASS_SHEAR = 3,
  CLASS_SHEAR_HALF = 4 /* one of the two that stand for a diagonal with a split end */
};

/* Link directions are taken in units of 2^LINK_SHIFT position steps. */
enum { LINK_SHIFT = 8, LINK_UNITS_MIN = 1024, LINK_UNITS_MAX = 8191 };

/* A class of structural links; index 0 stands for dead rows. R is the rest length in these units,
 * LINK_UNITS_MIN..MAX. */
typedef struct {
  int32_t rest;    /* Q24 lu */
  int32_t r2;      /* R^2, from the rest length in full, rounded */
  int32_t n_max;   /* R^2 * 25/16: longer links are taken as 25% too long */
  int32_t inverse; /* 2^36 / R^2 */
  int32_t push;    /* Q12, 0..4096: share of a projection that a compressed link gets */
} link_class;

static inline link_class link_class_make(int32_t rest, int32_t push) {
  const int64_t r2 = fx_round64(fx_mul_wide(rest, rest), 2 * LINK_SHIFT);
  const link_class c = {rest, (int32_t)r2, (int32_t)(r2 + r2 / 16 * 9),
                        (int32_t)(((int64_t)1 << 36) / (r2 > 0 ? r2 : 1)), push};
  return c;
}

/* A class of bend or shear springs: dv = gain * elongation, along the spring, for one tick, in
 * (lu per substep) per lu; gain = mantissa * 2^-shift, below 1/2. Directions are taken in units of
 * 2^down position steps, of which the rest length R is SPRING_UNITS_MIN..MAX. */
enum { SPRING_UNITS_MIN = 4096, SPRING_UNITS_MAX = 8191 };
enum { SPRING_REST_MIN = 1 << 13, SPRING_REST_MAX = 1 << 22 };
typedef struct {
  int32_t rest;     /* Q24 lu */
  int32_t mantissa; /* 0, or 2^15..2^16-1 */
  int32_t shift;    /* 17..46 */
  int32_t compression_only;
  int32_t down;     /* 1..10 */
  int32_t r2;       /* R^2 */
  int32_t idle;     /* |d|^2 from which on it does nothing: below R^2 by what rounding may take */
  int32_t inverse;  /* 2^39 / R^2 */
  int32_t pull;     /* the mantissa in 14 bits */
  int32_t scale;    /* 1..30: dv is a rounded product with the pull, shifted by it */
} spring_class;

/* What follows from the first four. */
static inline spring_class spring_class_make(int32_t rest, int32_t mantissa, int32_t shift,
                                             int32_t compression_only) {
  int32_t down = 1;
  int32_t r = fx_round(rest, 1);
  while (r > SPRING_UNITS_MAX) r = fx_round(rest, (unsigned)++down);
  const int32_t scale = shift - down - 6;
  const spring_class c = {rest,
                          scale > 30 ? 0 : mantissa,
                          shift,
                          compression_only,
                          down,
                          r * r,
                          compression_only != 0 ? r * r - 3 * r : INT32_MAX,
                          (int32_t)(((int64_t)1 << 39) / ((int64_t)r * r)),
                          scale > 30 ? 0 : fx_asr(mantissa, 2),
                          scale > 30 ? 30 : scale};
  return c;
}

/* What is free to move in the rows of a batch. Rows between two held particles are projected by
 * nobody, but they can tear. */
enum { BATCH_FREE = 0, BATCH_HELD = 1 /* end i is held, j is free */, BATCH_IDLE = 2 };
typedef struct {
  int32_t first; /* row */
  int32_t count;
  int32_t held;
} row_batch;

/* rest * (1 + strain), Q24 lu. A rest length is below 1/8 lu, a strain at most 4. */
static inline uint32_t link_stretched(int32_t rest, int32_t strain_q16) {
#if FX_NO_LONG_MULTIPLY
  const uint32_t r = (uint32_t)rest;
  const uint32_t s = (uint32_t)strain_q16;
  const uint32_t part = (r & 0xFFFFu) * (s & 0xFFFFu) >> 16;
  return r + r * (s >> 16) + (r >> 16) * (s & 0xFFFFu) + part;
#else
  return (uint32_t)(fx_mul_wide_u((uint32_t)rest, 65536u + (uint32_t)strain_q16) >> 16);
#endif
}
static inline uint64_t link_stretched_squared(int32_t rest, int32_t strain_q16) {
  return fx_square((int32_t)link_stretched(rest, strain_q16));
}

enum {
  LINK_CLASS_WORDS = sizeof(link_class) / 4,
  SPRING_CLASS_WORDS = sizeof(spring_class) / 4,
  BATCH_WORDS = sizeof(row_batch) / 4
};

#endif
