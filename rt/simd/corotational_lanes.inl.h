/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/state/corotational.c, same order of operations. The law of isotropic sheets, LANES
 * triangles at a time, in the low words of 64-bit lanes. Triangles that are pressed, or whose stress would be
 * clamped, are left to the scalar code, one by one. */
#ifndef FRAY_SIMD_COROTATIONAL_LANES_INL_H
#define FRAY_SIMD_COROTATIONAL_LANES_INL_H

#include "rt/state/corotational.h"
#include "rt/simd/lanes64.inl.h"

#if defined(LANES_HAVE_64) && FRAY_CRACKS
enum {
  COROTATIONAL_LANES_STRAIN = 58, /* before it is rounded: C is at most 5, what follows fits 32 bits */
  COROTATIONAL_LANES_STRESS = 57, /* of T, in the same way: S, at most three times that, fits 32 bits */
  COROTATIONAL_LANES_DET = 5, COROTATIONAL_LANES_TRACE = 3 /* pairs of zeros before the first bit */
};

typedef struct {
  lanes64 root, over; /* nearest_root() and inverse_root(), Q28 */
} corotational_lanes_root;

/* Of n below 2^62, with 2 to 2 `pairs` + 1 zeros before its first bit. */
LANES_INLINE corotational_lanes_root corotational_lanes_root_of(lanes64 n, int pairs) {
  const lanes high = lanes64_high(n);
  lanes fewer = lanes_set(-1); /* minus the pairs of zeros */
  LANES_UNROLL
  for (int k = 1; k < pairs; ++k)
    fewer = lanes_add(fewer, lanes_sign(lanes_sub(high, lanes_set(1 << (30 - 2 * k)))));
  const lanes64 up = lanes64_from(lanes_sub(lanes_set(0), fewer));
  const lanes64 normal = lanes64_shl_by64(n, lanes64_add(up, up));
  const lanes64 m = lanes64_shr(normal, 32);
  const lanes64 inverse = lanes64_inverse_root(normal);
  const lanes64 length =
      lanes64_shr_by64(lanes64_mul_low_u(m, inverse), lanes64_add(up, lanes64_set(30)));
  const lanes64 over = lanes64_shr_by64(lanes64_add(inverse, lanes64_shr_by64(lanes64_set(32), up)),
                                        lanes64_sub(lanes64_set(6), up));
  const lanes64 rest = lanes64_sub(n, lanes64_mul_low_u(length, length));
  const lanes64 off = lanes64_add(lanes64_mul_low_u(rest, over),
                                  lanes64_shl(lanes64_mul_low_u(lanes64_shr(rest, 32), over), 32));
  const lanes64 half = lanes64_set((int64_t)1 << (2 * STRAIN_BITS));
  const lanes64 halved = lanes64_add(off, lanes64_add(lanes64_sign(off), half));
  const lanes64 more = lanes64_shr(lanes64_asr_words(halved, 2 * STRAIN_BITS + 1 - 32), 32);
  return (corotational_lanes_root){lanes64_add_words(length, more), over};
}

/* What follows from C: low words, Q28. */
typedef struct {
  lanes64 counted_uu, counted_vv, counted_uv;
  lanes64 x_uu, x_vv, x_uv; /* U^-1 */
  lane_mask pressed;
} corotational_lanes_stretch;

/* C of U and V by low words: 1 + 2 G, as material_strain() rounds G. */
typedef struct {
  lanes64 uu, vv, uv;
} corotational_lanes_c;

/* Of U^2, Q56: G is rounded away from zero. */
LANES_INLINE lanes64 corotational_lanes_squared(lanes64 squared) {
  const lanes64 below = lanes64_sign(lanes64_sub(squared, lanes64_set((int64_t)1 << (2 * STRAIN_BITS))));
  const lanes64 half = lanes64_set((int64_t)1 << STRAIN_BITS);
  return lanes64_shl(lanes64_shr(lanes64_add(squared, lanes64_add(below, half)), STRAIN_BITS + 1), 1);
}
LANES_INLINE corotational_lanes_c corotational_lanes_c_of(const lanes64 u[3], const lanes64 v[3]) {
  return (corotational_lanes_c){corotational_lanes_squared(lanes64_dot_low(u, u)),
                                corotational_lanes_squared(lanes64_dot_low(v, v)),
                                lanes64_rounded(lanes64_dot_low(u, v), STRAIN_BITS)};
}
/* Whether a lane is drawn to twice its length or more; U and V are within 2 along each axis. */
LANES_INLINE int corotational_lanes_is_far(const corotational_lanes_c *c) {
  return lanes64_any_beyond(lanes64_or(c->uu, c->vv), STRAIN_BITS + 2);
}

/* Where not pressed. */
LANES_INLINE corotational_lanes_stretch corotational_lanes_stretch_of(const corotational_lanes_c *c) {
  const lanes64 one = lanes64_set(STRAIN_ONE);
  const lanes64 uu = c->uu;
  const lanes64 vv = c->vv;
  const lanes64 uv = c->uv;
  const lanes64 det = lanes64_sub(lanes64_mul_low_u(uu, vv), lanes64_mul_low(uv, uv));
  const corotational_lanes_root j = corotational_lanes_root_of(det, COROTATIONAL_LANES_DET);
  const lanes64 uu_j = lanes64_add(uu, j.root);
  const lanes64 vv_j = lanes64_add(vv, j.root);
  const lanes64 square = lanes64_shl(lanes64_add(uu_j, vv_j), STRAIN_BITS);
  const corotational_lanes_root t = corotational_lanes_root_of(square, COROTATIONAL_LANES_TRACE);
  corotational_lanes_stretch s;
  const lanes64 least = lanes64_sub(lanes64_add(lanes64_shl(j.root, 2), one), lanes64_shl(t.root, 1));
  s.pressed = lanes64_negative(
      lanes64_or(lanes64_or(least, lanes64_sub(t.root, one)),
                 lanes64_sub(det, lanes64_set((int64_t)1 << (2 * STRAIN_BITS - 4)))));
  s.counted_uu = lanes64_rounded(lanes64_mul_low(lanes64_sub(uu_j, t.root), t.over), STRAIN_BITS);
  s.counted_vv = lanes64_rounded(lanes64_mul_low(lanes64_sub(vv_j, t.root), t.over), STRAIN_BITS);
  s.counted_uv = lanes64_rounded(lanes64_mul_low(uv, t.over), STRAIN_BITS - 1);
  const lanes64 over = lanes64_rounded_u(lanes64_mul_low_u(j.over, t.over), STRAIN_BITS);
  s.x_uu = lanes64_rounded_u(lanes64_mul_low_u(vv_j, over), STRAIN_BITS);
  s.x_vv = lanes64_rounded_u(lanes64_mul_low_u(uu_j, over), STRAIN_BITS);
  s.x_uv = lanes64_sub(lanes64_set(0), lanes64_rounded(lanes64_mul_low(uv, over), STRAIN_BITS));
  return s;
}

/* T = c (U - 1) by low words. */
LANES_INLINE void corotational_lanes_tension(const lanes c[4], const corotational_lanes_stretch *s,
                                             lanes64 *far, lanes64 f[3]) {
  const lanes64 c0 = lanes64_words(c[0]);
  const lanes64 c1 = lanes64_words(c[1]);
  const lanes64 shear = lanes64_mul_low(lanes64_words(c[3]), s->counted_uv);
  f[0] = lanes64_dot2(far, c0, s->counted_uu, c1, s->counted_vv, STRAIN_BITS);
  f[1] = lanes64_dot2(far, c1, s->counted_uu, lanes64_words(c[2]), s->counted_vv, STRAIN_BITS);
  f[2] = lanes64_rounded(shear, STRAIN_BITS);
  *far = lanes64_or_size(*far, shear);
}

/* Lanes whose sums were beyond, and those that are pressed. */
LANES_INLINE uint32_t corotational_lanes_left(const corotational_lanes_stretch *s, lanes64 far) {
  const lanes beyond = lanes64_low(lanes64_shr(far, COROTATIONAL_LANES_STRESS));
  return mask_bits(mask_or(s->pressed, lanes_not_equal(beyond, lanes_set(0))));
}

/* S or T of lanes in `left`, from the scalar code. */
LANES_INLINE void corotational_lanes_one_by_one(const lanes c[4], const corotational_lanes_c *k,
                                                uint32_t left, int is_counted, lanes s[3]) {
  int32_t stiffness[MATERIAL_ENTRIES][LANES], strain[3][LANES], stress[3][LANES];
  const lanes one = lanes_set(STRAIN_ONE);
  lanes_store(strain[0], lanes_asr(lanes_sub(lanes64_low(k->uu), one), 1));
  lanes_store(strain[1], lanes_asr(lanes_sub(lanes64_low(k->vv), one), 1));
  lanes_store(strain[2], lanes64_low(k->uv));
  LANES_UNROLL
  for (int n = 0; n < MATERIAL_ENTRIES; ++n) lanes_store(stiffness[n], c[n]);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) lanes_store(stress[n], s[n]);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) {
    if ((left >> n & 1u) == 0) continue;
    const int32_t by[MATERIAL_ENTRIES] = {stiffness[0][n], stiffness[1][n], stiffness[2][n],
                                          stiffness[3][n]};
    const material_tensor green = {strain[0][n], strain[1][n], strain[2][n]};
    material_tensor counted;
    material_tensor found = corotational_stress(by, green, &counted);
    if (is_counted) found = material_stress(by, counted);
    stress[0][n] = found.uu;
    stress[1][n] = found.vv;
    stress[2][n] = found.uv;
  }
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) s[n] = lanes_load(stress[n]);
}

LANES_INLINE void corotational_lanes_replace(const lanes c[4], const corotational_lanes_c *k, uint32_t left,
                                             int is_counted, lanes64 s[3]) {
  lanes low[3];
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) low[n] = lanes64_low(s[n]);
  corotational_lanes_one_by_one(c, k, left, is_counted, low);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) s[n] = lanes64_words(low[n]);
}

LANES_INLINE lanes64 corotational_lanes_dot2(lanes64 a, lanes64 b, lanes64 c, lanes64 d) {
  return lanes64_rounded(lanes64_add(lanes64_mul_low(a, b), lanes64_mul_low(c, d)), STRAIN_BITS);
}

/* S by low words: corotational_stress(). */
LANES_INLINE void corotational_lanes_stress(const lanes c[4], const corotational_lanes_c *square,
                                            lanes64 s[3]) {
  const corotational_lanes_stretch k = corotational_lanes_stretch_of(square);
  lanes64 far = lanes64_set(0);
  lanes64 f[3];
  corotational_lanes_tension(c, &k, &far, f);
  const lanes64 both = lanes64_asr_words(lanes64_add_words(f[0], f[1]), 1);
  const lanes64 mean = lanes64_asr_words(lanes64_add_words(k.x_uu, k.x_vv), 1);
  s[0] = corotational_lanes_dot2(f[0], k.x_uu, f[2], k.x_uv);
  s[1] = corotational_lanes_dot2(f[1], k.x_vv, f[2], k.x_uv);
  s[2] = corotational_lanes_dot2(both, k.x_uv, f[2], mean);
  const uint32_t left = corotational_lanes_left(&k, far);
  if (left != 0) corotational_lanes_replace(c, square, left, 0, s);
}

/* T of Green's strain: what tears go by. */
LANES_INLINE void corotational_lanes_tension_of(const lanes c[4], const lanes g[3], lanes s[3]) {
  const lanes one = lanes_set(STRAIN_ONE);
  const corotational_lanes_c square = {lanes64_from(lanes_add(lanes_add(g[0], g[0]), one)),
                                       lanes64_from(lanes_add(lanes_add(g[1], g[1]), one)),
                                       lanes64_words(g[2])};
  const corotational_lanes_stretch k = corotational_lanes_stretch_of(&square);
  lanes64 far = lanes64_set(0);
  lanes64 f[3];
  corotational_lanes_tension(c, &k, &far, f);
  const uint32_t left = corotational_lanes_left(&k, far);
  if (left != 0) corotational_lanes_replace(c, &square, left, 1, f);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) s[n] = lanes64_low(f[n]);
}
#endif

#endif
