/* SPDX-License-Identifier: Apache-2.0 */
/* corotational.h has the formulas. */
#include "rt/state/corotational.h"

#if FRAY_CRACKS

enum { PRESSED_STRAIN = -3 * (STRAIN_ONE / 8) /* Green's, of a stretch of 1/2 */ };

static int64_t corotational_round(int64_t a, int64_t b) { return fx_round64(fx_mul64(a, b), STRAIN_BITS); }

/* root(square), Q28, to the nearest: fx_root_length() rounds down, which would be a stress at rest. */
static int64_t nearest_root(int64_t square, fx_root root, int32_t inverse) {
  const int64_t length = fx_root_length(root);
  const int64_t rest = square - fx_mul64(length, length);
  return length + fx_round64(fx_mul64(rest, inverse), 2 * STRAIN_BITS + 1);
}

/* 1 over that, Q28, below 8. */
static int32_t inverse_root(fx_root root) { return (int32_t)fx_root_over(root, STRAIN_ONE, STRAIN_BITS); }

/* A principal strain as it counts, and the slope of that. */
typedef struct {
  int32_t counted, slope;
} pressed_strain;

static pressed_strain pressed_strain_of(int32_t g) {
  if (g <= PRESSED_STRAIN) return (pressed_strain){2 * g + STRAIN_ONE / 4, 2 * STRAIN_ONE};
  const uint64_t squared = (uint64_t)((int64_t)STRAIN_ONE + 2 * (int64_t)g) << STRAIN_BITS;
  const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
  const pressed_strain k = {(int32_t)((int64_t)fx_root_length(root) - STRAIN_ONE), inverse_root(root)};
  return k;
}

/* From principal values to the axes of c; cosine and sine of twice the angle, Q30. */
static material_tensor turned_back(int64_t major, int64_t minor, int32_t cosine, int32_t sine) {
  const int64_t half = fx_asr64(major - minor, 1);
  const int64_t apart = fx_round64(fx_mul64(half, cosine), 30);
  const int64_t middle = fx_asr64(major + minor, 1);
  const material_tensor s = {fx_saturate(middle + apart), fx_saturate(middle - apart),
                             fx_saturate(fx_round64(fx_mul64(half, sine), 30))};
  return s;
}

static material_tensor pressed_stress(const int32_t c[MATERIAL_ENTRIES], material_tensor g,
                                      material_tensor *counted) {
  const int32_t x = fx_sub(g.uu, g.vv);
  const uint64_t squared = fx_square(x) + fx_square(g.uv);
  const fx_root root = fx_rsqrt(squared == 0 ? 1 : squared, FX_ROOT_FINE);
  const int64_t apart = squared == 0 ? 0 : fx_root_length(root); /* of the principal strains */
  const int64_t sum = (int64_t)g.uu + g.vv;
  const int32_t cosine = squared == 0 ? 1 << 30 : fx_root_unit(root, x);
  const int32_t sine = squared == 0 ? 0 : fx_root_unit(root, g.uv);
  const int64_t largest = fx_clamp64(fx_round64(sum + apart, 1), -STRAIN_ONE / 2, STRAIN_MAX);
  const int64_t least = fx_clamp64(sum - largest, -STRAIN_ONE / 2, STRAIN_MAX);
  const pressed_strain major = pressed_strain_of((int32_t)largest);
  const pressed_strain minor = pressed_strain_of((int32_t)least);
  *counted = turned_back(major.counted, minor.counted, cosine, sine);
  counted->uv = fx_add(counted->uv, counted->uv);
  const int64_t t1 =
      material_round(fx_mul_wide(c[0], major.counted) + fx_mul_wide(c[1], minor.counted));
  const int64_t t2 =
      material_round(fx_mul_wide(c[1], major.counted) + fx_mul_wide(c[2], minor.counted));
  return turned_back(corotational_round(t1, major.slope), corotational_round(t2, minor.slope), cosine, sine);
}

material_tensor corotational_stress(const int32_t c[MATERIAL_ENTRIES], material_tensor g,
                                    material_tensor *counted) {
  const int64_t one = STRAIN_ONE;
  const int64_t uu = one + 2 * (int64_t)g.uu; /* C, below 9 */
  const int64_t vv = one + 2 * (int64_t)g.vv;
  const int64_t det = fx_mul64(uu, vv) - fx_mul_wide(g.uv, g.uv);
  FRAY_ASSERT(g.uu <= STRAIN_MAX && g.vv <= STRAIN_MAX);
  if (det < (one * one) >> 4) return pressed_stress(c, g, counted);
  const fx_root of_det = fx_rsqrt((uint64_t)det, FX_ROOT_FINE);
  const int32_t over_j = inverse_root(of_det);
  const int64_t j = nearest_root(det, of_det, over_j);
  const int64_t square = (uu + vv + 2 * j) * one; /* below 2^62 */
  const fx_root of_square = fx_rsqrt((uint64_t)square, FX_ROOT_FINE);
  const int32_t over_t = inverse_root(of_square);
  const int64_t t = nearest_root(square, of_square, over_t);
  if (t < one || 4 * j + one < 2 * t) return pressed_stress(c, g, counted); /* (l1 - 1/2) (l2 - 1/2) < 0 */
  counted->uu = (int32_t)corotational_round(uu + j - t, over_t);
  counted->vv = (int32_t)corotational_round(vv + j - t, over_t);
  counted->uv = (int32_t)corotational_round(2 * (int64_t)g.uv, over_t);
  const material_tensor f = material_stress(c, *counted);
  const int64_t over = corotational_round(over_j, over_t);
  const int64_t x_uu = corotational_round(vv + j, over); /* U^-1, at most 2 */
  const int64_t x_vv = corotational_round(uu + j, over);
  const int64_t x_uv = -corotational_round(g.uv, over);
  const int64_t both = fx_asr64((int64_t)f.uu + f.vv, 1);
  const int64_t mean = fx_asr64(x_uu + x_vv, 1);
  const material_tensor s = {
      fx_saturate(fx_round64(fx_add64(fx_mul64(f.uu, x_uu), fx_mul64(f.uv, x_uv)), STRAIN_BITS)),
      fx_saturate(fx_round64(fx_add64(fx_mul64(f.vv, x_vv), fx_mul64(f.uv, x_uv)), STRAIN_BITS)),
      fx_saturate(fx_round64(fx_add64(fx_mul64(both, x_uv), fx_mul64(f.uv, mean)), STRAIN_BITS))};
  return s;
}

material_tensor corotational_tension(const int32_t c[MATERIAL_ENTRIES], material_tensor g) {
  material_tensor counted;
  (void)corotational_stress(c, g, &counted);
  return material_stress(c, counted);
}

#endif
