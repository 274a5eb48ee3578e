/* SPDX-License-Identifier: Apache-2.0 */
/* The stress of a strain in double precision, by the words of rt/state/material.h: angles by atan2,
 * means and roots as written. */
#ifndef FRAY_TESTS_PHYSICS_MATERIAL_REFERENCE_H
#define FRAY_TESTS_PHYSICS_MATERIAL_REFERENCE_H

#include <math.h>

#include "rt/state/material.h"

typedef struct {
  double uu, vv, uv; /* uv of a strain is twice Green's shear */
} reference_tensor;

static inline double reference_row(const material_table *f, double rows, uint32_t n) {
  const int row = rows >= 4 ? 3 : (int)rows;
  const double share = rows - row;
  return f->stretch[1 + row][n] * (1 - share) + f->stretch[2 + row][n] * share;
}

/* N/m. */
static inline void reference_stiffness(const material_table *f, reference_tensor g, double c[MATERIAL_ENTRIES]) {
  const double pi = acos(-1.0);
  const double spread = hypot((g.uu - g.vv) / 2, g.uv / 2);
  const double largest = (g.uu + g.vv) / 2 + spread;
  const double level = largest <= 0 ? 0 : fmin(1, 6 * (sqrt(1 + 2 * largest) - 1));
  const double turned = atan2(fabs(g.uv), g.uu - g.vv) / 2;
  const double apart = largest <= 0 ? 0 : fmin(1, 16 * spread / largest);
  for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n) {
    const double directed = reference_row(f, turned / (pi / 8), n);
    const double mean = (f->stretch[1][n] + 2.0 * f->stretch[2][n] + 2.0 * f->stretch[3][n] +
                         2.0 * f->stretch[4][n] + f->stretch[5][n]) /
                        8;
    const double stretched = mean * (1 - apart) + directed * apart;
    c[n] = (f->stretch[0][n] * (1 - level) + stretched * level) / 4096;
  }
}

static inline reference_tensor reference_stress(const material_table *f, reference_tensor g) {
  double c[MATERIAL_ENTRIES];
  reference_stiffness(f, g, c);
  const reference_tensor s = {c[0] * g.uu + c[1] * g.vv, c[1] * g.uu + c[2] * g.vv, c[3] * g.uv};
  return s;
}

#endif
