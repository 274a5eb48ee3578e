/* SPDX-License-Identifier: Apache-2.0 */
/* Bending of a membrane: a plate whose triangles have constant moments (Morley 1968; Hellan, Herrmann,
 * Johnson). Formulas are in membrane/bend_force.c; here is what they work on.
 *
 *   angle      between two triangles, and a triangle's part of it            Q28 rad
 *   offset     by which a triangle's part of a side's angle differs from its share; that of the other
 *              triangle is the opposite. It is relaxed in every bending step  Q28 rad
 *   habit      curvature that the stiffness goes by: a lowpass of the curvature of the last ticks, of two
 *              poles as that of the strain, in steps of the material's table   Q24
 *   stiffness  of material_table.bend, and H: impulse times lu in a bending step, by rad, Q`bend_bits`
 *   moment     impulse times lu, Q(bend_bits - 2): a row of H times three angles fits 30 bits */
#ifndef FRAY_STATE_BEND_PLATE_H
#define FRAY_STATE_BEND_PLATE_H

#include "rt/state/material.h"
#include "rt/state/spring.h"

enum {
  BEND_ANGLE_BITS = 28,
  BEND_OFFSET_MAX = 80530637, /* 0.3 rad: more would let a fold become a crease in one triangle */
  BEND_HABIT_BITS = 24,
  BEND_HABIT_MAX = 8 << BEND_HABIT_BITS, /* twice the table */
  BEND_ENTRY_MAX = 1 << 28,              /* of H */
  BEND_REACH = FX_LU * 16,               /* Q28: corners farther apart along an axis are taken as a lu */
  BEND_AREA_DOWN = 30,                   /* from Q56 of |N|^2 */
  BEND_FLAT = 1 << 16,                   /* Q56: a triangle of a squared normal below that has no side */
  BEND_ENERGY_MAX = 1 << 29,             /* Q(bend_bits - 3), in a bending step */
  BEND_ONE = 1 << 30                     /* Q30 */
};

/* Of a triangle. */
typedef struct {
  int32_t offset[3]; /* of each side, 0 on the boundary */
  int32_t habit[SMOOTHED_STRAIN_POLES];
  int32_t faded; /* Q30: what is lost of its angles, as it is pressed together or was */
  int32_t owed;  /* an energy, within BEND_ENERGY_MAX: membrane/bend_owed.c */
} bend_state;
enum { BEND_STATE_WORDS = sizeof(bend_state) / 4 };

/* Of a triangle at rest. With sides of length e, outward normals n and the area A */
typedef struct {
  int32_t side[3][3];   /* Q26: e / root(A) (n_u^2, n_v^2, 2 n_u n_v), saturated at 32 */
  int32_t inverse_root; /* Q16 of 1 / lu: 1 / root(A) */
} bend_shape;

/* What is left of a triangle by its height on side k, Q30: 5/4 of that at rest, at most 1. With the angle's
 * gradient 1 / h it would vibrate faster as the square of that. `normal` is twice its area, `length` the
 * side's, both as they are now, Q28. */
static inline int32_t bend_fade_by_height(const bend_shape *s, uint32_t k, uint32_t normal, uint32_t length) {
  const uint64_t across = fx_mul_wide_u(normal, (uint32_t)s->inverse_root) >> 16; /* over root(A) */
  const uint64_t side = (uint64_t)(uint32_t)s->side[k][0] + (uint32_t)s->side[k][1];
  const uint64_t high =
      (across > UINT32_MAX ? UINT32_MAX : across) * (side > UINT32_MAX ? UINT32_MAX : side) >> 26;
  if (5u * high >= (uint64_t)length * 8u) return BEND_ONE;
  return (int32_t)fx_divide_wide(5u * high << 27, length);
}

/* Of a triangle in this tick: columns, each as long as the pool of triangles. */
enum {
  PLATE_H00, PLATE_H11, PLATE_H22, PLATE_H01, PLATE_H02, PLATE_H12, /* H of sides */
  PLATE_PER_LENGTH_0, PLATE_PER_LENGTH_1, PLATE_PER_LENGTH_2, /* 1 / |e| of sides, Q20 of 1 / lu */
  PLATE_AREA_MIN, /* of |N|^2 in bending steps, Q26 of lu^4: see bend_prepare.c */
  PLATE_FADE,     /* Q30, see there */
  PLATE_COLUMNS
};
typedef struct {
  int32_t words[PLATE_COLUMNS];
} bend_plate_words;

/* Of a side between two triangles: columns, each as long as three halves of the pool of triangles. A place is
 * four times the triangle and the number of the side in it. */
enum {
  FOLD_FIRST,    /* its place in the triangle of the lower number */
  FOLD_SECOND,   /* and in the other */
  FOLD_BASE,     /* a vertex of the first */
  FOLD_OPPOSITE, /* the vertex of the second that is not on the side */
  FOLD_SHARE,    /* Q30: of the angle, that of the first */
  FOLD_CAP,      /* Q30: part of the angle that counts, 1 but where small triangles are */
  FOLD_HOLD,     /* the same, times how far both triangles are pressed together in this tick */
  FOLD_RATE,     /* Q20: change of the offset by the difference of moments */
  FOLD_OFFSET,   /* of the first triangle; a copy of the state while a tick lasts */
  FOLD_COLUMNS
};
enum { FOLD_RATE_BITS = 20 };
typedef struct {
  int32_t words[(3 * FOLD_COLUMNS + 1) / 2];
} bend_fold_words;

/* The unit normal of a triangle Q30, and with N twice its area times that, 1 / |N|: Q30, and in the five
 * lowest bits h, by 2^-h of 2^28 / lu^2. Both 0: it has none. */
typedef struct {
  int32_t n[3], per_area;
} bend_normal;
enum { BEND_EXPONENT = 31, BEND_PER_LENGTH_BITS = 20 };
static inline int32_t bend_per_area_of(fx_root root) {
  return (int32_t)((root.inverse >> 1 & ~(uint32_t)BEND_EXPONENT) | root.h);
}

/* Of a triangle's sides: in a bending step angles, then moments of the triangle, then of the sides. */
typedef struct {
  int32_t side[3], padding;
} bend_moment;

#endif
