/* SPDX-License-Identifier: Apache-2.0 */
/* What the AVX2 loops share: an approximate root and a Newton step, which was never slower than a
 * root and a division. */
#ifndef FRAY_TOOLS_BENCH_FLOAT_AVX2_H
#define FRAY_TOOLS_BENCH_FLOAT_AVX2_H

#if defined(__x86_64__) || defined(__i386__)
#define FLOAT_AVX2 1
#include <immintrin.h>

#define AVX2_TARGET __attribute__((target("avx2,fma")))
#define AVX2_INLINE __attribute__((always_inline, target("avx2,fma"))) static inline

typedef struct {
  __m256 x, y, z;
} float_vec8;

/* The share of d that an end takes: all - reach / |d|, within 2^-22. */
AVX2_INLINE __m256 float_share(float_vec8 d, __m256 reach, __m256 all) {
  const __m256 n = _mm256_fmadd_ps(d.x, d.x, _mm256_fmadd_ps(d.y, d.y, _mm256_mul_ps(d.z, d.z)));
  const __m256 y = _mm256_rsqrt_ps(n);
  const __m256 half = _mm256_mul_ps(_mm256_mul_ps(n, y), _mm256_set1_ps(-0.5f));
  const __m256 newton = _mm256_fmadd_ps(half, y, _mm256_set1_ps(1.5f));
  return _mm256_fnmadd_ps(_mm256_mul_ps(reach, y), newton, all);
}
#else
#define FLOAT_AVX2 0
#endif

#endif
