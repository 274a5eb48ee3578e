/* SPDX-License-Identifier: Apache-2.0 */
/* What the scalar strain limiting (woven/strain_limit.c, with its derivation) and its kernel share. */
#ifndef FRAY_SIMD_LINK_TERMS_H
#define FRAY_SIMD_LINK_TERMS_H

#include "rt/base/vec.h"
#include "rt/state/spring.h"

enum {
  LINK_HI_MAX = 16383,
  LINK_THIRD = 2731, /* 2/3 in Q12: the factor of half a correction where an end has half mass */
  LINK_U_LEAST = -458752, /* -7/16 in Q20 */
  LINK_PSI_0 = 16384,     /* 1/4 in Q16 */
  LINK_PSI_1 = -12648,    /* -0.193 */
  LINK_PSI_2 = 9961,      /* 0.152 */
  /* the constants of both Horner steps, before their shifts */
  LINK_HORNER_1 = LINK_PSI_1 * 32768 + (1 << 14),
  LINK_HORNER_0 = LINK_PSI_0 * 32768 + (1 << 14)
};

/* The constants of the kernel, in memory: lanes load each with one broadcast, where compilers would rebuild
 * literals for every group. */
typedef struct {
  int32_t difference_half, hi_most, hi_least, e_half, u_half, u_least, psi_2, horner_1, horner_0, f_half,
      step_half;
} link_words;
extern const link_words simd_link_words;

/* The arguments of simd_strain_limit() and simd_tear_scan(). */
typedef struct {
  int32_t *restrict x, *restrict y, *restrict z; /* particles, Q24 lu, within +-FX_WORLD_MAX; written */
  const index_t *i, *j;      /* one for each spring: its ends; springs of a batch share no particle */
  const uint8_t *kind;       /* one for each spring: class and SPRING_ bits, SPRING_DEAD for none */
  const link_class *classes;
  uint32_t class_count; /* of classes that may be read as a table; 0: unknown */
  int is_lock;          /* diagonals of a shear lock, of link_class_of_lock(): long enough, they stay */
} link_view;

/* One component of d, in units of 2^LINK_SHIFT, in 16 bits. */
static inline int32_t link_coarse(int32_t d) { return fx_saturate16(fx_round(d, LINK_SHIFT)); }
static inline vec3 link_coarse_vec(vec3 d) {
  return vec_make(link_coarse(d.x), link_coarse(d.y), link_coarse(d.z));
}

/* |d|^2 in the units of hi, from d^2 = 2^2s hi^2 + 2^(s+1) hi lo + ..., where 2^s hi lo is hi d less
 * 2^s hi^2; the sums may wrap, their difference is small. A d with a saturated component
 * gives more than 2^28, whatever its low bits. */
static inline uint32_t link_squared(vec3 d, vec3 hi) {
  const uint32_t n = (uint32_t)fx_mul(hi.x, hi.x) + (uint32_t)fx_mul(hi.y, hi.y) +
                     (uint32_t)fx_mul(hi.z, hi.z);
  const int32_t along = fx_wrap_add(fx_wrap_add(fx_wrap_mul(hi.x, d.x), fx_wrap_mul(hi.y, d.y)),
                                    fx_wrap_mul(hi.z, d.z));
  const int32_t cross = fx_wrap_sub(along, fx_wrap_shift((int32_t)n, LINK_SHIFT));
  return (uint32_t)fx_wrap_add((int32_t)n, fx_asr(cross, LINK_SHIFT - 1));
}

/* A diagonal is longer than its lock R where |dx| + |dy| + |dz| is root 3 of R: here 7/4, in units of
 * 2^LOCK_FAR_SHIFT position steps, so that sums of three fit. */
enum { LOCK_FAR_SHIFT = 2 };
static inline int32_t lock_far(const link_class *lock) { return fx_asr(7 * lock->rest, 2 + LOCK_FAR_SHIFT); }

/* d from i to j. */
static inline vec3 link_vec(const link_view *s, uint32_t i, uint32_t j) {
  return vec_sub(vec_at(s->x, s->y, s->z, j), vec_at(s->x, s->y, s->z, i));
}

#endif
