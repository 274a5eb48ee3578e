/* SPDX-License-Identifier: Apache-2.0 */
/* SIMD kernels: the hot loops, many springs, particles or triangles at a time, equal to the scalar code to
 * the last bit. simd_NAME(kernel, ...) runs a kernel; there are three contracts, a table each:
 *
 *  SIMD_LOOPS     takes every element. The scalar code is the same plain C loop (particle_loops.h).
 *  SIMD_PREFIXES  takes elements from the front and returns how many: the caller's scalar loop
 *                 takes what it leaves, one element or all, and may call it again.
 *                 FRAY_KERNEL_SCALAR takes none.
 *  SIMD_SEARCHES  rules elements out. What it does not rule out, the caller measures exactly;
 *                 FRAY_KERNEL_SCALAR rules nothing out.
 *
 * The kernel of NAME is NAME_lanes_run() in NAME_lanes.inl.h, compiled once for each instruction set
 * (SET.c). */
#ifndef FRAY_SIMD_SIMD_H
#define FRAY_SIMD_SIMD_H

#include "rt/base/hash.h"
#include "rt/fray.h"
#include "rt/simd/broad_phase.h"
#include "rt/simd/ground_contact_view.h"
#include "rt/simd/link_terms.h"
#include "rt/simd/membrane_view.h"
#include "rt/simd/particle_loops.h"
#include "rt/simd/spring_terms.h"

/* X(set, name, parameters, arguments): returns what the loop of this name in particle_loops.h returns. */
#define SIMD_LOOPS(X, set) \
  X(set, advance, \
    (int32_t * x, int32_t *q, int32_t *v, int8_t *r, uint32_t first, uint32_t end, int32_t gravity), \
    (x, q, v, r, first, end, gravity)) \
  X(set, carry, \
    (int32_t * x, int32_t *q, int32_t *v, const int32_t *offset, uint32_t first, uint32_t end, \
     int32_t centre, int32_t velocity), \
    (x, q, v, offset, first, end, centre, velocity)) \
  X(set, velocity, (const int32_t *x, const int32_t *q, int32_t *v, uint32_t first, uint32_t end), \
    (x, q, v, first, end)) \
  X(set, drag, (int32_t * v, uint32_t first, uint32_t end, int32_t share), (v, first, end, share)) \
  X(set, rotation, \
    (rigid_fit * m, const int32_t *x, const int32_t *y, const int32_t *z, const int32_t *vx, \
     const int32_t *vy, const int32_t *vz, uint32_t first, uint32_t end), \
    (m, x, y, z, vx, vy, vz, first, end)) \
  X(set, follow, \
    (const rigid_fit *m, int32_t share, const int32_t *x, const int32_t *y, const int32_t *z, \
     int32_t *vx, int32_t *vy, int32_t *vz, uint32_t first, uint32_t end), \
    (m, share, x, y, z, vx, vy, vz, first, end))

/* X(set, name, parameters, arguments): returns how many elements it took, from the front. */
#define SIMD_PREFIXES(X, set) \
  /* springs of `count` consecutive batches, both ends free: all of them */ \
  X(set, strain_limit, (link_view v, const spring_batch *batches, uint32_t count), (v, batches, count)) \
  X(set, bend_shear, (bend_shear_view v, const spring_batch *batches, uint32_t count), (v, batches, count)) \
  /* contacts first..end-1, all with one plane that faces up: all of them */ \
  X(set, ground_contact, (ground_contact_view * v, uint32_t first, uint32_t end), (v, first, end)) \
  /* crossings first..end-1 of one colour: no two share a particle */ \
  /* triangles first..end-1, once a tick */ \
  X(set, membrane_stress, (const stress_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  X(set, corotational_stress, (const stress_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  X(set, wind, (const wind_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  X(set, bend_stiffness, (const plate_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  X(set, bend_geometry, (const plate_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  /* triangles, folds, vertices first..end-1 in an elastic step */ \
  X(set, membrane_force, (const force_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  X(set, corotational_force, (const force_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  X(set, bend_normals, (const bend_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  X(set, bend_folds, (const bend_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  X(set, bend_moments, (const bend_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  X(set, bend_joints, (const bend_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  X(set, bend_corners, (const bend_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  X(set, membrane_step, (const step_view *v, uint32_t first, uint32_t end), (v, first, end)) \
  /* three hashes over `count` elements each */ \
  X(set, hash_words, (hash h[3], const int32_t *const words[3], uint32_t count), (h, words, count)) \
  X(set, hash_bytes, (hash h[3], const int8_t *const bytes[3], uint32_t count), (h, bytes, count))

/* X(set, name, parameters, arguments, what the scalar code says). */
#define SIMD_SEARCHES(X, set) \
  /* the first of springs first..end-1 that may be stretched by more than tear_min, Q16; `end` if none */ \
  X(set, tear_scan, (link_view v, int32_t tear_min, uint32_t first, uint32_t end), \
    (v, tear_min, first, end), simd_first) \
  /* 0 iff none of particles first..end-1 can come near the box, or the plane, before the tick ends */ \
  SIMD_NEAR(X, set, near_box) \
  SIMD_NEAR(X, set, near_plane)
#define SIMD_NEAR(X, set, name) \
  X(set, name, \
    (const broad_phase *g, const int32_t *x, const int32_t *y, const int32_t *z, const int32_t *vx, \
     const int32_t *vy, const int32_t *vz, uint32_t first, uint32_t end), \
    (g, x, y, z, vx, vy, vz, first, end), simd_maybe)

#define simd_none(v, a, b) ((void)(v), (void)(a), (void)(b), 0u)
#define simd_first(v, tear_min, first, end) ((void)(v), (void)(tear_min), (void)(end), first)
#define simd_maybe(g, x, y, z, vx, vy, vz, first, end) \
  ((void)(g), (void)(x), (void)(y), (void)(z), (void)(vx), (void)(vy), (void)(vz), (void)(first), \
   (void)(end), 1u)

/* Which sets this build has. */
#if defined(__x86_64__) && defined(__SSE2__)
#define SIMD_HAS_X86
#define SIMD_SETS(X) X(AVX2, avx2) X(AVX512, avx512)
#define SIMD_CASES(name, arguments)                              \
  case FRAY_KERNEL_AVX2: return simd_##name##_avx2 arguments;    \
  case FRAY_KERNEL_AVX512: return simd_##name##_avx512 arguments;
#elif defined(__aarch64__) && defined(__ARM_NEON) && !defined(__ARM_BIG_ENDIAN)
#define SIMD_HAS_NEON
#define SIMD_SETS(X) X(NEON, neon)
#define SIMD_CASES(name, arguments) \
  case FRAY_KERNEL_NEON: return simd_##name##_neon arguments;
#elif defined(__ARM_FEATURE_MVE) && !defined(__ARM_BIG_ENDIAN)
#define SIMD_HAS_HELIUM
#define SIMD_SETS(X) X(HELIUM, helium)
#define SIMD_CASES(name, arguments) \
  case FRAY_KERNEL_HELIUM: return simd_##name##_helium arguments;
#else
#define SIMD_SETS(X)
#define SIMD_CASES(name, arguments)
#endif

#define SIMD_DECLARE(set, name, parameters, ...) uint32_t simd_##name##_##set parameters;
#define SIMD_DECLARE_SET(SET, set) \
  SIMD_LOOPS(SIMD_DECLARE, set) SIMD_PREFIXES(SIMD_DECLARE, set) SIMD_SEARCHES(SIMD_DECLARE, set)
SIMD_SETS(SIMD_DECLARE_SET)

/* simd_NAME(kernel, ...): a closed switch, so that the stack bound of a call is known. */
#define SIMD_OPEN(...) __VA_ARGS__
#define SIMD_CHOOSE(name, parameters, arguments, scalar) \
  static inline uint32_t simd_##name(fray_kernel kernel, SIMD_OPEN parameters) { \
    FRAY_ASSERT((uint32_t)kernel <= FRAY_KERNEL_HELIUM); \
    switch (kernel) { \
      SIMD_CASES(name, arguments) \
      default: return scalar arguments; \
    } \
  }
#define SIMD_CHOOSE_LOOP(set, name, parameters, arguments) \
  SIMD_CHOOSE(name, parameters, arguments, loop_##name)
#define SIMD_CHOOSE_PREFIX(set, name, parameters, arguments) \
  SIMD_CHOOSE(name, parameters, arguments, simd_none)
#define SIMD_CHOOSE_SEARCH(set, name, parameters, arguments, scalar) \
  SIMD_CHOOSE(name, parameters, arguments, scalar)
SIMD_LOOPS(SIMD_CHOOSE_LOOP, any)
SIMD_PREFIXES(SIMD_CHOOSE_PREFIX, any)
SIMD_SEARCHES(SIMD_CHOOSE_SEARCH, any)

/* How many elements the scalar code takes where a kernel of a prefix stopped: SIMD_LEFT, and twice as many
 * each time that the kernel took none, so that what it never takes costs few calls. */
enum { SIMD_LEFT = 8, SIMD_LEFT_MAX = 128 };
static inline uint32_t simd_left(uint32_t before, uint32_t taken) {
  if (taken != 0) return SIMD_LEFT;
  return before < SIMD_LEFT_MAX ? 2u * before : before;
}

#endif
