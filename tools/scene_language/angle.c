/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/scene_language/angle.h"

/* Q60 holds |values| below 8; the half angle stays below 1.5 rad. */
#define ONE ((int64_t)1 << 60)
#define PI_Q60 INT64_C(3622009729038561421)

static int64_t product(int64_t a, int64_t b) {
  int64_t result = 0;
  return exact_mul_div(a, b, ONE, &result) ? result : 0;
}

/* Taylor's series from the term x^first / first!, until its terms vanish. */
static int64_t series(int64_t x, int64_t term, int first) {
  int64_t sum = 0;
  for (int k = first; term != 0; k += 2) {
    sum += term;
    term = -product(product(term, x), x) / ((k + 1) * (k + 2));
  }
  return sum;
}

exact angle_half_tangent(exact degrees) {
  int64_t half_turns, steps;
  exact share = exact_div(degrees, exact_make(360, 1));
  if (!exact_to_fixed(share, 60, &half_turns)) return exact_make(0, 0);
  int64_t x = product(half_turns, PI_Q60);
  int64_t sine = series(x, x, 1), cosine = series(x, ONE, 0);
  if (cosine <= 0 || !exact_mul_div(sine, ANGLE_STEPS, cosine, &steps)) return exact_make(0, 0);
  return exact_make(steps, ANGLE_STEPS);
}
