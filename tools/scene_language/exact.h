/* SPDX-License-Identifier: Apache-2.0 */
/* Exact decimals: every number of a scene stays a ratio of integers until it is rounded once, so that a
 * scene gives the same image on every machine. */
#ifndef FRAY_TOOLS_SCENE_LANGUAGE_EXACT_H
#define FRAY_TOOLS_SCENE_LANGUAGE_EXACT_H

#include <stdint.h>

/* numerator / denominator in lowest terms, denominator > 0; denominator 0 marks an overflow, which
 * every operation propagates. */
typedef struct {
  int64_t numerator;
  int64_t denominator;
} exact;

exact exact_make(int64_t numerator, int64_t denominator);
exact exact_mul(exact a, exact b);
exact exact_div(exact a, exact b);
exact exact_add(exact a, exact b);
exact exact_sub(exact a, exact b);
int exact_valid(exact a);
int exact_compare(exact a, exact b); /* sign of a - b, both valid; never overflows */

/* round(a * 2^shift), halves away from zero. Returns 0 iff a is invalid or the result leaves
 * int64. shift 0..62. */
int exact_to_fixed(exact a, unsigned shift, int64_t *result);

/* round(a * b / c) in 128 bits, halves away from zero; c > 0. Returns 0 iff it leaves int64. */
int exact_mul_div(int64_t a, int64_t b, int64_t c, int64_t *result);

/* floor(sqrt(n)). */
uint32_t exact_sqrt(uint64_t n);

#endif
