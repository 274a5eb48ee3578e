/* SPDX-License-Identifier: Apache-2.0 */
/* What the cloth of a triangle sheet is made of, and the stress of a strain (Karaoz 2015, sections 2.2
 * and 2.5; the tables are those of Wang, O'Brien, Ramamoorthi 2011).
 *
 *   strain    Green's, G = ([U V]'[U V] - 1) / 2 (2.28 to 2.31): uu and vv are its diagonal, uv is
 *             U.V, twice its shear, as 2.31 has it
 *   stress    uu = c11 uu + c12 vv, vv = c12 uu + c22 vv, uv = c33 * U.V: so c33 takes twice Green's
 *             shear, and (2.11) gives c33 = E / (2 (1 + nu))
 *   c         by direction and level. The direction is the angle of the larger principal strain
 *             against the weft, mirrored into 0 to 90 degrees: rows 1 to 5 stand at 0, 22.5, 45, 67.5
 *             and 90. The level is that strain's stretch, sqrt(1 + 2 G): row 0 at 1, blending into the
 *             others, which hold from 1 + 1/6 on. Both are linear in between. A strain that is the same
 *             in all directions has none: where half of what the principal strains differ is below 1/16
 *             of the larger, the rows fade into their mean over all directions, so that c has no step
 *
 *   quantity   format     range
 *   U, V       Q28        +-4, saturated
 *   strain     Q28        -1/2 to 4, shear +-4, saturated
 *   c          Q12 N/m    below 2^18 N/m, see FABRIC_STIFF_MAX
 *   stress     Q12 N/m    saturated to 2^19 N/m
 *   bend       2^-40 N m */
#ifndef FRAY_MODEL_FABRIC_H
#define FRAY_MODEL_FABRIC_H

#include "rt/base/vec.h"

enum {
  FABRIC_ROWS = 6,     /* at rest, then five directions */
  FABRIC_ENTRIES = 4,  /* c11, c12, c22, c33 */
  FABRIC_BENDS = 3,    /* across the weft's direction, 45 degrees, the warp's */
  FABRIC_CURVES = 5,   /* at curvatures 0, 5, 10, 15, 20 / m */
  FABRIC_STIFF_MAX = 1 << 30
};
enum { STRAIN_BITS = 28, STRAIN_ONE = 1 << STRAIN_BITS, STRAIN_MAX = 1 << 30 };

typedef struct {
  int32_t stretch[FABRIC_ROWS][FABRIC_ENTRIES]; /* what moves the sheet: measured times scale */
  int32_t bend[FABRIC_BENDS][FABRIC_CURVES];
  int32_t scale; /* Q30: 1 << 30, or less where the measured stiffness is too much for the work */
} fabric;
enum { FABRIC_WORDS = sizeof(fabric) / 4 };

typedef struct {
  int32_t uu, vv, uv;
} tensor;

/* Green's strain of a triangle whose weft and warp have become U and V. */
static inline int32_t fabric_bounded(int64_t strain) {
  return (int32_t)fx_clamp64(strain, -STRAIN_MAX, STRAIN_MAX);
}
static inline tensor fabric_strain(vec3 u, vec3 v) {
  const int64_t one = (int64_t)1 << (2 * STRAIN_BITS);
  const int64_t uv = fx_mul_wide(u.x, v.x) + fx_mul_wide(u.y, v.y) + fx_mul_wide(u.z, v.z);
  const tensor g = {fabric_bounded(fx_round64((int64_t)vec_squared(u) - one, STRAIN_BITS + 1)),
                    fabric_bounded(fx_round64((int64_t)vec_squared(v) - one, STRAIN_BITS + 1)),
                    fabric_bounded(fx_round64(uv, STRAIN_BITS))};
  return g;
}

/* c11, c12, c22, c33 at this strain. Cost: two roots, two divisions. */
void fabric_stiffness(const fabric *f, tensor strain, int32_t c[FABRIC_ENTRIES]);

/* The strain that c goes by: what the strain has been over the last ticks, HABIT_POLES times averaged, Q28.
 * A table by direction and level is no energy's derivative: its stress, taken at once, is stiffer in one
 * way than in the other, and a sheet that trembles gains from that. A c that stands still while it does
 * gives nothing; at rest c is that of the strain. */
enum { HABIT_POLES = 2 };
typedef struct {
  tensor mean[HABIT_POLES];
} habit;
enum { HABIT_WORDS = sizeof(habit) / 4 };

/* Q12 N/m. */
tensor fabric_stress(const int32_t c[FABRIC_ENTRIES], tensor strain);

/* Where a direction stands between the rows: 0 at 0 degrees, 4 at 90, Q28; a sixth of a millionth of a
 * right angle off at most. x and y are the cosine and sine of twice the angle times any number, y >= 0,
 * |x| and y at most 2^30, not both 0. */
int32_t fabric_direction(int32_t x, int32_t y);

/* atan(t) / 45 degrees = t (1 + (1 - t^2) q(t^2)) for t in 0..1: exact at both ends, 6e-6 off
 * between. Coefficients of q, Q28. */
extern const int32_t fabric_eighth[5];

#endif
