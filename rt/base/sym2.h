/* SPDX-License-Identifier: Apache-2.0 */
/* Symmetric 2 x 2 matrices, in any format; entries are at most 2^29 in size. */
#ifndef FRAY_BASE_SYM2_H
#define FRAY_BASE_SYM2_H

#include "rt/base/fx.h"

typedef struct {
  int32_t xx, yy, xy;
} sym2;

/* Eigenvalues, major >= minor; their sum is exactly xx + yy, each is off by at most 1 + 2^-28 of the largest
 * entry. cosine and sine are those of twice the angle from x to the direction of major, Q30; 1 and 0 where
 * all directions are the same. */
typedef struct {
  int32_t major, minor;
  int32_t cosine, sine;
} sym2_eigen;

static inline sym2_eigen sym2_eigen_of(sym2 m) {
  const int32_t x = fx_sub(m.xx, m.yy);
  const int32_t y = fx_add(m.xy, m.xy);
  const int32_t trace = fx_add(m.xx, m.yy);
  const uint64_t squared = fx_square(x) + fx_square(y);
  sym2_eigen e = {0, 0, 1 << 30, 0};
  if (squared == 0) {
    e.major = fx_round(trace, 1);
  } else {
    const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
    e.major = (int32_t)fx_round64((int64_t)trace + fx_root_length(root), 1);
    e.cosine = fx_root_unit(root, x);
    e.sine = fx_root_unit(root, y);
  }
  e.minor = fx_sub(trace, e.major);
  return e;
}

/* The tensile part: the matrix with its positive eigenvalues only. */
static inline sym2 sym2_positive(sym2 m) {
  const sym2_eigen e = sym2_eigen_of(m);
  const sym2 none = {0, 0, 0};
  if (e.minor >= 0) return m;
  if (e.major <= 0) return none;
  const int64_t whole = (int64_t)e.major * ((int64_t)1 << 30);
  sym2 p;
  p.xx = (int32_t)fx_round64(fx_add64(whole, fx_mul_wide(e.major, e.cosine)), 31);
  p.yy = fx_sub(e.major, p.xx);
  p.xy = fx_mul_round(e.major, e.sine, 31);
  return p;
}

#endif
