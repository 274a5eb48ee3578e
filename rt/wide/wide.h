/* SPDX-License-Identifier: Apache-2.0 */
/* Wide kernels: the hot loops, many rows or particles at a time, equal to the scalar code to the
 * last bit. Each instruction set is one small file: what its lanes can do. What they compute is
 * written once: rows in project.h and push.h, loops over particles in sweeps.h, which scalar code
 * shares, the hash in digest.h. */
#ifndef FRAY_WIDE_WIDE_H
#define FRAY_WIDE_WIDE_H

#include "rt/base/hash.h"
#include "rt/fray.h"
#include "rt/wide/inner.h"
#include "rt/wide/level.h"
#include "rt/wide/link.h"
#include "rt/wide/reach.h"
#include "rt/wide/slide.h"
#include "rt/wide/spring.h"
#include "rt/wide/sweeps.h"

/* Every kernel: X(set, name, parameters, arguments, scalar function, wide function). Each answers how
 * many rounds or rows it took, from the front, and the caller's scalar loop takes the rest; sweeps
 * take all, whatever they answer. */
#define WIDE_TABLE(X, set)                                                                       \
  /* batches that stand one after the other, both ends free: all rows or none */                 \
  X(set, project, (link_view s, const row_batch *batches, uint32_t count), (s, batches, count),  \
    wide_none, project_batches)                                                                  \
  X(set, push, (spring_view s, const row_batch *batches, uint32_t count), (s, batches, count),   \
    wide_none, push_batches)                                                                     \
  /* the first of rows first..end-1 that may be over its threshold: the scalar one, any */        \
  X(set, over, (link_view s, int32_t tear_min, uint32_t first, uint32_t end),                    \
    (s, tear_min, first, end), wide_first, over_next)                                            \
  /* whether any particle may come near a body; the scalar one cannot rule it out */             \
  X(set, near_box,                                                                               \
    (const reach *g, const int32_t *x, const int32_t *y, const int32_t *z, const int32_t *vx,    \
     const int32_t *vy, const int32_t *vz, uint32_t first, uint32_t end),                        \
    (g, x, y, z, vx, vy, vz, first, end), wide_maybe, near_any)                                  \
  X(set, near_plane,                                                                             \
    (const reach *g, const int32_t *x, const int32_t *y, const int32_t *z, const int32_t *vx,    \
     const int32_t *vy, const int32_t *vz, uint32_t first, uint32_t end),                        \
    (g, x, y, z, vx, vy, vz, first, end), wide_maybe, near_any_above)                            \
  /* contacts first..end-1, all with one plane that faces up */                                  \
  X(set, level, (level_view * v, uint32_t first, uint32_t end), (v, first, end), wide_none,      \
    lift_contacts)                                                                              \
  /* couples first..end-1, which share no particle */                                           \
  X(set, slide, (const slide_view *v, uint32_t first, uint32_t end), (v, first, end), wide_none, \
    slides_run)                                                                                  \
  /* triangles, creases, vertices first..end-1 of an inner step */                              \
  X(set, pull, (const pull_view *v, uint32_t first, uint32_t end), (v, first, end), wide_none,   \
    pulls_run)                                                                                   \
  X(set, fold, (const fold_view *v, uint32_t first, uint32_t end), (v, first, end), wide_none,   \
    folds_run)                                                                                   \
  /* triangles, creases first..end-1, once a tick */                                            \
  X(set, stress, (const stress_view *v, uint32_t first, uint32_t end), (v, first, end),          \
    wide_none, stresses_run)                                                                     \
  X(set, blow, (const blow_view *v, uint32_t first, uint32_t end), (v, first, end), wide_none,   \
    blows_run)                                                                                   \
  X(set, weigh, (const weigh_view *v, uint32_t first, uint32_t end), (v, first, end), wide_none, \
    weighs_run)                                                                                  \
  X(set, inner, (const inner_view *v, uint32_t first, uint32_t end), (v, first, end), wide_none, \
    inner_steps)                                                                                 \
  X(set, hash_words, (hash * h, const int32_t *const *words, uint32_t count), (h, words, count), \
    wide_none, digest_of_words)                                                                  \
  X(set, hash_bytes, (hash * h, const int8_t *const *bytes, uint32_t count), (h, bytes, count),  \
    wide_none, digest_of_bytes)                                                                  \
  X(set, advance,                                                                                \
    (int32_t * x, int32_t *q, int32_t *v, int8_t *r, uint32_t first, uint32_t end,               \
     int32_t gravity),                                                                           \
    (x, q, v, r, first, end, gravity), sweep_advance, sweep_advance)                             \
  X(set, carry,                                                                                  \
    (int32_t * x, int32_t *q, int32_t *v, const int32_t *grip, uint32_t first, uint32_t end,     \
     int32_t centre, int32_t velocity),                                                          \
    (x, q, v, grip, first, end, centre, velocity), sweep_carry, sweep_carry)                     \
  X(set, take_over,                                                                              \
    (const int32_t *x, const int32_t *q, int32_t *v, uint32_t first, uint32_t end),              \
    (x, q, v, first, end), sweep_take_over, sweep_take_over)                                     \
  X(set, drag, (int32_t * v, uint32_t first, uint32_t end, int32_t share),                       \
    (v, first, end, share), sweep_drag, sweep_drag)                                              \
  X(set, turning,                                                                                \
    (sweep_motion * m, const int32_t *x, const int32_t *y, const int32_t *z, const int32_t *vx,  \
     const int32_t *vy, const int32_t *vz, uint32_t first, uint32_t end),                        \
    (m, x, y, z, vx, vy, vz, first, end), sweep_turning, sweep_turning)                          \
  X(set, follow,                                                                                 \
    (const sweep_motion *m, int32_t share, const int32_t *x, const int32_t *y, const int32_t *z, \
     int32_t *vx, int32_t *vy, int32_t *vz, uint32_t first, uint32_t end),                       \
    (m, share, x, y, z, vx, vy, vz, first, end), sweep_follow, sweep_follow)

#define wide_none(a, b, c) ((void)(a), (void)(b), (void)(c), 0u)
#define wide_first(s, tear_min, first, end) ((void)(s), (void)(tear_min), (void)(end), first)
#define wide_maybe(g, x, y, z, vx, vy, vz, first, end)                                       \
  ((void)(g), (void)(x), (void)(y), (void)(z), (void)(vx), (void)(vy), (void)(vz), (void)(first), \
   (void)(end), 1u)

/* Which sets this build has. */
#if defined(__x86_64__) && defined(__SSE2__)
#define WIDE_HAS_X86
#define WIDE_SETS(X) X(AVX2, avx2) X(AVX512, avx512)
#define WIDE_CASES(name, arguments)                              \
  case FRAY_KERNEL_AVX2: return wide_##name##_avx2 arguments;    \
  case FRAY_KERNEL_AVX512: return wide_##name##_avx512 arguments;
#elif defined(__aarch64__) && defined(__ARM_NEON) && !defined(__ARM_BIG_ENDIAN)
#define WIDE_HAS_NEON
#define WIDE_SETS(X) X(NEON, neon)
#define WIDE_CASES(name, arguments) \
  case FRAY_KERNEL_NEON: return wide_##name##_neon arguments;
#elif defined(__ARM_FEATURE_MVE) && !defined(__ARM_BIG_ENDIAN)
#define WIDE_HAS_HELIUM
#define WIDE_SETS(X) X(HELIUM, helium)
#define WIDE_CASES(name, arguments) \
  case FRAY_KERNEL_HELIUM: return wide_##name##_helium arguments;
#else
#define WIDE_SETS(X)
#define WIDE_CASES(name, arguments)
#endif

#define WIDE_DECLARE(set, name, parameters, arguments, scalar, wide) \
  uint32_t wide_##name##_##set parameters;
#define WIDE_DECLARE_SET(SET, set) WIDE_TABLE(WIDE_DECLARE, set)
WIDE_SETS(WIDE_DECLARE_SET)

/* wide_NAME(kernel, ...) */
#define WIDE_OPEN(...) __VA_ARGS__
#define WIDE_CHOOSE(set, name, parameters, arguments, scalar, wide)                       \
  static inline uint32_t wide_##name(fray_kernel kernel, WIDE_OPEN parameters) {          \
    switch (kernel) {                                                                     \
      WIDE_CASES(name, arguments)                                                         \
      default: return scalar arguments;                                                   \
    }                                                                                     \
  }
WIDE_TABLE(WIDE_CHOOSE, any)

#endif
