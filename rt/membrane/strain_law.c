/* SPDX-License-Identifier: Apache-2.0 */
/* strain_law.h has the formulas.
 *
 *   strains, stretches   Q28   principal strains are below 6
 *   r, f', directions    Q28   0..1, +-1
 *   stress               that of c, within 2^31 */
#include "rt/membrane/strain_law.h"

enum { LAW_BOUND_Q18 = 891290 /* 3.4 */ };

int32_t strain_law_threshold(uint32_t slope, uint32_t room, uint32_t steps) {
  const uint64_t bound = (uint64_t)room * steps * LAW_BOUND_Q18; /* Q48; room is 4 at most, steps 2^10 */
  const uint32_t divisor = slope < 1 ? 1 : slope > INT32_MAX ? INT32_MAX : slope;
  const uint32_t ratio = fx_divide_wide(bound, divisor); /* Q28 */
  if (ratio <= (uint32_t)STRAIN_ONE) return 0;
  return fx_min((int32_t)((ratio - (uint32_t)STRAIN_ONE) / 3u), STRAIN_LAW_MAX);
}

static int32_t mul_q28(int32_t a, int32_t b) { return fx_mul_round(a, b, STRAIN_BITS); }

/* 2 a / b, both Q28 and not negative, for at most 1. */
static int32_t twice_over(int32_t a, int64_t b) {
  const uint32_t ratio = fx_divide_wide((uint64_t)(uint32_t)a << (STRAIN_BITS + 1), (uint32_t)b);
  return ratio > (uint32_t)STRAIN_ONE ? STRAIN_ONE : (int32_t)ratio;
}

static int32_t stretch_of(int32_t strain) {
  const uint64_t squared = (uint64_t)((int64_t)STRAIN_ONE + 2 * (int64_t)strain) << STRAIN_BITS;
  return (int32_t)fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
}

/* A principal strain under the law. */
typedef struct {
  int32_t strain, stretch, r, counted, slope;
} law_strain;

static law_strain law_strain_of(int32_t strain, int32_t threshold, int32_t s0) {
  law_strain k = {strain, s0, STRAIN_ONE, strain, STRAIN_ONE};
  if (strain <= threshold) return k;
  k.stretch = fx_max(stretch_of(strain), s0);
  const int32_t x = k.stretch - s0;
  k.r = twice_over(STRAIN_ONE, (int64_t)2 * STRAIN_ONE + x);
  k.counted = threshold + mul_q28(mul_q28(s0, x), k.r);
  k.slope = twice_over(mul_q28(s0, mul_q28(k.r, k.r)) / 2, k.stretch);
  return k;
}

/* (f(g1) - f(g2)) / (g1 - g2), where g1 is above the threshold: without a difference of near values. */
static int32_t law_shear(const law_strain *major, const law_strain *minor, int32_t threshold, int32_t s0,
                         int32_t apart) {
  if (minor->strain > threshold)
    return twice_over(mul_q28(s0, mul_q28(major->r, minor->r)), (int64_t)major->stretch + minor->stretch);
  const int32_t chord = twice_over(mul_q28(s0, major->r), (int64_t)major->stretch + s0);
  const int32_t above = twice_over((major->strain - threshold) / 2, fx_max(apart, 1));
  return STRAIN_ONE - mul_q28(STRAIN_ONE - chord, above);
}

static int64_t round_q28(int64_t a, int32_t b) { return fx_round64(fx_mul64(a, b), STRAIN_BITS); }

/* From the axes of c to the principal ones and back: t and s of material_tensor, cosine and sine of twice the
 * angle between them. */
static material_tensor law_pull_back(const material_tensor *t, const law_strain *major,
                                     const law_strain *minor, int32_t shear, int32_t cosine, int32_t sine) {
  const int64_t sum = (int64_t)t->uu + t->vv;
  const int64_t half_apart = fx_asr64((int64_t)t->uu - t->vv, 1);
  const int64_t along = round_q28(half_apart, cosine) + round_q28(t->uv, sine);
  const int64_t across = round_q28(t->uv, cosine) - round_q28(half_apart, sine);
  const int64_t s1 = round_q28(fx_asr64(sum, 1) + along, major->slope);
  const int64_t s2 = round_q28(fx_asr64(sum, 1) - along, minor->slope);
  const int64_t s12 = round_q28(across, shear);
  const int64_t middle = fx_asr64(s1 + s2, 1);
  const int64_t half = fx_asr64(s1 - s2, 1);
  const int64_t difference = round_q28(half, cosine) - round_q28(s12, sine);
  const material_tensor s = {fx_saturate(middle + difference), fx_saturate(middle - difference),
                             fx_saturate(round_q28(half, sine) + round_q28(s12, cosine))};
  return s;
}

material_tensor strain_law_stress(const int32_t c[MATERIAL_ENTRIES], material_tensor g, int32_t threshold,
                                  material_tensor *counted) {
  FRAY_ASSERT(threshold >= 0 && g.uu <= STRAIN_MAX && g.vv <= STRAIN_MAX);
  const int32_t x = fx_sub(g.uu, g.vv);
  const uint64_t squared = fx_square(x) + fx_square(g.uv);
  const fx_root root = fx_rsqrt(squared == 0 ? 1 : squared, FX_ROOT_FINE);
  const int32_t apart = squared == 0 ? 0 : (int32_t)fx_root_length(root); /* of the principal strains */
  const int64_t sum = (int64_t)g.uu + g.vv;
  const int32_t largest = (int32_t)fx_round64(sum + apart, 1);
  *counted = g;
  if (largest <= threshold) return material_stress(c, g);
  const int32_t cosine = squared == 0 ? STRAIN_ONE : fx_round(fx_root_unit(root, x), 2);
  const int32_t sine = squared == 0 ? 0 : fx_round(fx_root_unit(root, g.uv), 2);
  const int32_t s0 = stretch_of(threshold);
  const law_strain major = law_strain_of(largest, threshold, s0);
  const law_strain minor = law_strain_of((int32_t)(sum - largest), threshold, s0);
  const int32_t shear = law_shear(&major, &minor, threshold, s0, apart);
  const int32_t spread = fx_sub(major.counted, minor.counted);
  const int64_t both = (int64_t)major.counted + minor.counted;
  counted->uu = fx_saturate(fx_round64(both * STRAIN_ONE + fx_mul_wide(spread, cosine), STRAIN_BITS + 1));
  counted->vv = fx_saturate(both - counted->uu);
  counted->uv = mul_q28(spread, sine);
  const material_tensor t = material_stress(c, *counted);
  return law_pull_back(&t, &major, &minor, shear, cosine, sine);
}
