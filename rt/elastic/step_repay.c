/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/elastic/step_repay.h"

/* Down by so many bits it has 31. */
static unsigned bits_above(uint64_t v) {
  const unsigned zeros = fx_leading_zeros64(v | 1u);
  return zeros < 33u ? 33u - zeros : 0;
}

step_energy_unit step_energy_unit_over(uint64_t v) {
  FRAY_ASSERT(v != 0);
  const unsigned zeros = fx_leading_zeros64(v);
  const uint32_t top = (uint32_t)(v << zeros >> 33); /* 2^30 to 2^31 - 1 */
  const step_energy_unit unit = {fx_divide_wide((uint64_t)1 << 61, top), 61 + 33 - (int)zeros};
  return unit;
}

/* m u^2 / 2: a mass in Q16, a speed in Q28. */
static int32_t energy_of(int32_t mass, int32_t speed, step_energy_unit unit) {
  const uint64_t squared = fx_square(speed);
  const unsigned up = bits_above(squared);
  const uint64_t twice = fx_mul_wide_u((uint32_t)(squared >> up), (uint32_t)mass);
  const unsigned more = bits_above(twice);
  const uint64_t product = fx_mul_wide_u((uint32_t)(twice >> more), unit.by);
  const unsigned most = bits_above(product);
  const uint32_t energy = (uint32_t)(product >> most);
  const int shift = (int)(up + more + most) - unit.bits - (2 * FX_VELOCITY_BITS + STEP_MASS_BITS + 1);
  if (shift <= 0) return shift < -31 ? 0 : (int32_t)(energy >> -shift);
  return shift > 30 || energy >> (31 - shift) != 0 ? INT32_MAX : (int32_t)(energy << shift);
}

/* Inverse, Q24. */
static uint64_t inverse_mass_of(const fray_world *w, const step_motion *m) {
  uint64_t sum = 0;
  for (uint32_t k = 0; k < m->count; ++k)
    sum += fx_mul_wide_u((uint32_t)(vec_squared(m->along[k]) >> 32), step_inverse_mass(w, m->vertex[k]));
  return sum >> (2 * STEP_MOTION_BITS - 32);
}

/* u, Q28 lu per substep. */
static int32_t speed_of(const fray_world *w, const step_motion *m, const elastic_step *step) {
  int64_t sum = 0;
  for (uint32_t k = 0; k < m->count; ++k)
    sum += vec_dot64(vec_sub_saturated(step_velocity(w, m->vertex[k], step),
                                       step_half_of(w, m->vertex[k], step)),
                     m->along[k]);
  return fx_saturate(fx_round64(sum, STEP_MOTION_BITS));
}

static void push(fray_world *w, const step_motion *m, int32_t mass, int32_t change) {
  vec64 back = {0, 0, 0};
  for (uint32_t k = 1; k < m->count; ++k) {
    const vec3 by = vec_round_saturated(vec_scale64(m->along[k], change), STEP_MOTION_BITS);
    const vec64 impulse = step_impulse_of(mass, by);
    const vec64 against = {-impulse.x, -impulse.y, -impulse.z};
    back = vec_add64(back, against);
    (void)step_push(w, m->vertex[k], impulse);
  }
  (void)step_push(w, m->vertex[0], back);
}

int32_t step_repay(fray_world *w, const step_motion *motion, int32_t owed, step_energy_unit unit,
                   const elastic_step *step) {
  FRAY_ASSERT(owed >= 0 && motion->count >= 2 && motion->count <= STEP_MOTION_VERTICES);
  const uint64_t inverse = inverse_mass_of(w, motion);
  if (inverse == 0) return owed;
  const int32_t mass = step_mass_of(inverse);
  const int32_t speed = speed_of(w, motion, step);
  const int32_t energy = energy_of(mass, speed, unit);
  const int32_t wanted = fx_min(owed, energy / 2);
  if (wanted <= 0) return owed;
  const int32_t part = (int32_t)fx_divide_wide((uint64_t)(uint32_t)wanted << 30, (uint32_t)energy);
  push(w, motion, mass, -fx_mul_round(speed, part, 31));
  return owed - fx_max(wanted - fx_mul_round(wanted, part, 32) - 1, 0);
}
