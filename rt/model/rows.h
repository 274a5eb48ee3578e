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

enum { ROW_DEAD = 0 };

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
 * (lu per substep) per lu; gain = mantissa * 2^-shift, below 1/2. */
typedef struct {
  int32_t rest;     /* Q24 lu */
  int32_t mantissa; /* 0, or 2^15..2^16-1 */
  int32_t shift;    /* 17..46 */
  int32_t compression_only;
} spring_class;

/* What is free to move in the rows of a batch. Rows between two held particles are projected by
 * nobody, but they can tear. */
enum { BATCH_FREE = 0, BATCH_HELD = 1 /* end i is held, j is free */, BATCH_IDLE = 2 };
typedef struct {
  int32_t first; /* row */
  int32_t count;
  int32_t held;
} row_batch;

enum {
  LINK_CLASS_WORDS = sizeof(link_class) / 4,
  SPRING_CLASS_WORDS = sizeof(spring_class) / 4,
  BATCH_WORDS = sizeof(row_batch) / 4
};

#endif
