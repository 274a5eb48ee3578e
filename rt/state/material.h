/* SPDX-License-Identifier: Apache-2.0 */
/* Material of the membrane: anisotropic stiffness from a table, and the stress of a strain (Karaoz 2015,
 * sections 2.2 and 2.5; the tables are those of Wang, O'Brien, Ramamoorthi 2011).
 *
 *   strain    Green's, G = ([U V]'[U V] - 1) / 2 (2.28 to 2.31): uu and vv are its diagonal, uv is
 *             U.V, twice its shear, as 2.31 has it
 *   stress    uu = c11 uu + c12 vv, vv = c12 uu + c22 vv, uv = c33 * U.V: so c33 takes twice Green's
 *             shear, and (2.11) gives c33 = E / (2 (1 + nu))
 *   c         by direction and level. The direction is the angle of the larger principal strain
 *             against the weft, mirrored into 0 to 90 degrees: rows 1 to 5 are at 0, 22.5, 45, 67.5
 *             and 90. The level is that strain's stretch, sqrt(1 + 2 G): row 0 at 1, blending into the
 *             others, which hold from 1 + 1/6 on. Both are linear in between. A strain that is the same
 *             in all directions has no direction: where half the difference of the principal strains is
 *             below 1/16 of the larger, the rows fade into their mean over all directions, so that c has
 *             no step
 *
 *   quantity   format     range
 *   U, V       Q28        +-4, saturated
 *   strain     Q28        -1/2 to 4, shear +-4, saturated
 *   c          Q12 N/m    below 2^18 N/m, see MATERIAL_STIFF_MAX
 *   stress     Q12 N/m    saturated to 2^19 N/m
 *   bend       state/bend_plate.h, below MATERIAL_BEND_MAX */
#ifndef FRAY_STATE_MATERIAL_H
#define FRAY_STATE_MATERIAL_H

#include "rt/base/vec.h"

enum {
  MATERIAL_ROWS = 6,     /* at rest, then five directions */
  MATERIAL_ENTRIES = 4,  /* c11, c12, c22, c33 */
  MATERIAL_BENDS = 3,    /* curvature along the weft, along the warp, twist */
  MATERIAL_CURVES = 5,   /* at curvatures 0, 5, 10, 15, 20 / m */
  MATERIAL_STIFF_MAX = 1 << 30,
  MATERIAL_BEND_MAX = 1 << 26
};
enum { STRAIN_BITS = 28, STRAIN_ONE = 1 << STRAIN_BITS, STRAIN_MAX = 1 << 30 };

typedef struct {
  int32_t stretch[MATERIAL_ROWS][MATERIAL_ENTRIES]; /* of the elastic steps: measured times scale */
  int32_t bend[MATERIAL_BENDS][MATERIAL_CURVES];
  int32_t scale; /* Q30: 1 << 30, or less where the measured stiffness would take too many steps */
} material_table;
enum { MATERIAL_WORDS = sizeof(material_table) / 4 };

typedef struct {
  int32_t uu, vv, uv;
} material_tensor;

/* Green's strain of a triangle whose weft and warp have become U and V. */
static inline material_tensor material_strain(vec3 u, vec3 v) {
  const int64_t one = (int64_t)1 << (2 * STRAIN_BITS);
  const material_tensor g = {
      fx_clamp_wide(fx_round64((int64_t)vec_squared(u) - one, STRAIN_BITS + 1), STRAIN_MAX),
      fx_clamp_wide(fx_round64((int64_t)vec_squared(v) - one, STRAIN_BITS + 1), STRAIN_MAX),
      fx_clamp_wide(fx_round64(vec_dot64(u, v), STRAIN_BITS), STRAIN_MAX)};
  return g;
}

/* c11, c12, c22, c33 at this strain. Cost: two roots, two divisions. */
void material_stiffness(const material_table *f, material_tensor strain, int32_t c[MATERIAL_ENTRIES]);

/* The strain that c depends on: a lowpass of the strain over the last ticks, of SMOOTHED_STRAIN_POLES poles,
 * Q28. A table by direction and level is no energy's derivative: with c at the strain of the moment, stress
 * is stiffer in one direction of a vibration than in the other, and adds energy to it. A c that stays
 * constant meanwhile adds none; at rest c is that of the strain. */
enum { SMOOTHED_STRAIN_POLES = 2 };
typedef struct {
  material_tensor mean[SMOOTHED_STRAIN_POLES];
  int32_t c[MATERIAL_ENTRIES]; /* at that, in use; c11 is 0 before its first tick */
  int32_t owed;                /* material_energy() that a c which followed the strain has made */
} stiffness_state;
enum { STIFFNESS_STATE_WORDS = sizeof(stiffness_state) / 4, MATERIAL_ENERGY_MAX = 1 << 28 };
enum {
  MATERIAL_ENERGY_LEAST = 16, /* below, energies are rounding */
  STIFFNESS_RISE = 3,
  STIFFNESS_RISE_BITS = 3 /* by 3/8 of its energy while a strain is smoothed */
};

/* A product with a strain, in the other factor's format. */
static inline int32_t material_round(int64_t product) {
  return fx_saturate(fx_round64(product, STRAIN_BITS));
}
/* In the format of c. */
static inline material_tensor material_stress(const int32_t c[MATERIAL_ENTRIES], material_tensor strain) {
  const material_tensor s = {material_round(fx_mul_wide(c[0], strain.uu) + fx_mul_wide(c[1], strain.vv)),
                             material_round(fx_mul_wide(c[1], strain.uu) + fx_mul_wide(c[2], strain.vv)),
                             material_round(fx_mul_wide(c[3], strain.uv))};
  return s;
}

/* Stress times strain: twice an energy by area, Q40 of N/m over 2^energy_shift. */
static inline int32_t material_energy(material_tensor stress, material_tensor strain, unsigned shift) {
  const int64_t sum = fx_mul_wide(stress.uu, strain.uu) + fx_mul_wide(stress.vv, strain.vv) +
                      fx_mul_wide(stress.uv, strain.uv);
  return fx_clamp_wide(fx_round64(sum, shift), MATERIAL_ENERGY_MAX);
}

/* The position of a direction between the rows: 0 at 0 degrees, 4 at 90, Q28; at most a sixth of a millionth
 * of a right angle off. x and y are the cosine and sine of twice the angle times any number, y >= 0, |x| and
 * y at most 2^30, not both 0. */
int32_t material_direction(int32_t x, int32_t y);

/* atan(t) / 45 degrees = t (1 + (1 - t^2) q(t^2)) for t in 0..1: exact at both ends, 6e-6 off
 * between. Coefficients of q, Q28. */
extern const int32_t material_arctan[5];

#endif
