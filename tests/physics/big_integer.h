/* SPDX-License-Identifier: Apache-2.0 */
/* Integers of up to BIG_LIMBS * 32 bits, exact; a result that does not fit ends the program. */
#ifndef FRAY_TESTS_PHYSICS_BIG_INTEGER_H
#define FRAY_TESTS_PHYSICS_BIG_INTEGER_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BIG_LIMBS = 256 };

typedef struct {
  int sign; /* -1, 0, 1 */
  uint32_t count;
  uint32_t limb[BIG_LIMBS]; /* least first, the last one not 0 */
} big;

static inline void big_copy(big *to, const big *from) {
  to->sign = from->sign;
  to->count = from->count;
  memmove(to->limb, from->limb, from->count * sizeof from->limb[0]);
}
static inline void big_set(big *a, int64_t v) {
  uint64_t m = v < 0 ? 0 - (uint64_t)v : (uint64_t)v;
  a->sign = v < 0 ? -1 : v > 0;
  a->count = 0;
  for (; m != 0; m >>= 32) a->limb[a->count++] = (uint32_t)m;
}
static inline void big_trim(big *a) {
  while (a->count > 0 && a->limb[a->count - 1u] == 0) --a->count;
  if (a->count == 0) a->sign = 0;
}
static inline void big_room(uint32_t limbs) {
  if (limbs <= BIG_LIMBS) return;
  printf("big: %u limbs needed\n", limbs);
  exit(1);
}
static inline int big_compare_sizes(const big *a, const big *b) {
  if (a->count != b->count) return a->count < b->count ? -1 : 1;
  for (uint32_t n = a->count; n-- > 0;)
    if (a->limb[n] != b->limb[n]) return a->limb[n] < b->limb[n] ? -1 : 1;
  return 0;
}

/* |a| + |b| and, for |a| >= |b|, |a| - |b|; `to` may be a or b. The sign is the caller's. */
static inline void big_add_sizes(big *to, const big *a, const big *b) {
  const uint32_t most = a->count > b->count ? a->count : b->count;
  uint64_t carry = 0;
  big_room(most + 1u);
  for (uint32_t n = 0; n < most; ++n) {
    carry += n < a->count ? a->limb[n] : 0;
    carry += n < b->count ? b->limb[n] : 0;
    to->limb[n] = (uint32_t)carry;
    carry >>= 32;
  }
  to->count = most;
  if (carry != 0) to->limb[to->count++] = (uint32_t)carry;
}
static inline void big_subtract_sizes(big *to, const big *a, const big *b) {
  uint64_t borrow = 0;
  const uint32_t count = a->count;
  for (uint32_t n = 0; n < count; ++n) {
    const uint64_t d = (uint64_t)a->limb[n] - (n < b->count ? b->limb[n] : 0) - borrow;
    to->limb[n] = (uint32_t)d;
    borrow = d >> 63;
  }
  to->count = count;
}
static inline void big_sum(big *to, const big *a, const big *b, int sign_b) {
  if (b->sign == 0) {
    big_copy(to, a);
  } else if (a->sign == 0) {
    big_copy(to, b);
    to->sign = sign_b;
  } else if (a->sign == sign_b) {
    const int sign = a->sign;
    big_add_sizes(to, a, b);
    to->sign = sign;
  } else {
    const int order = big_compare_sizes(a, b);
    const int sign = order < 0 ? sign_b : a->sign;
    if (order < 0)
      big_subtract_sizes(to, b, a);
    else
      big_subtract_sizes(to, a, b);
    to->sign = sign;
    big_trim(to);
  }
}
static inline void big_add(big *to, const big *a, const big *b) { big_sum(to, a, b, b->sign); }
static inline void big_subtract(big *to, const big *a, const big *b) {
  big_sum(to, a, b, -b->sign);
}

/* `to` is neither a nor b. */
static inline void big_multiply(big *to, const big *a, const big *b) {
  big_room(a->count + b->count);
  to->sign = a->sign * b->sign;
  to->count = to->sign == 0 ? 0 : a->count + b->count;
  memset(to->limb, 0, to->count * sizeof to->limb[0]);
  if (to->sign == 0) return;
  for (uint32_t n = 0; n < a->count; ++n) {
    uint64_t carry = 0;
    for (uint32_t k = 0; k < b->count; ++k) {
      carry += (uint64_t)a->limb[n] * b->limb[k] + to->limb[n + k];
      to->limb[n + k] = (uint32_t)carry;
      carry >>= 32;
    }
    to->limb[n + b->count] = (uint32_t)carry;
  }
  big_trim(to);
}

static inline void big_shift_left(big *a, uint32_t bits) {
  const uint32_t whole = bits / 32u;
  const uint32_t part = bits % 32u;
  if (a->sign == 0) return;
  big_room(a->count + whole + 1u);
  a->limb[a->count] = 0;
  for (uint32_t n = a->count + 1u; n-- > 0;) {
    const uint64_t pair = (uint64_t)a->limb[n] << 32 | (n > 0 ? a->limb[n - 1u] : 0);
    a->limb[n + whole] = (uint32_t)(pair << part >> 32);
  }
  memset(a->limb, 0, whole * sizeof a->limb[0]);
  a->count += whole + 1u;
  big_trim(a);
}
static inline void big_shift_right(big *a, uint32_t bits) { /* of the size: towards zero */
  const uint32_t whole = bits / 32u;
  const uint32_t part = bits % 32u;
  if (whole >= a->count) {
    big_set(a, 0);
    return;
  }
  for (uint32_t n = whole; n < a->count; ++n) {
    const uint64_t pair = (n + 1u < a->count ? (uint64_t)a->limb[n + 1u] << 32 : 0) | a->limb[n];
    a->limb[n - whole] = (uint32_t)(pair >> part);
  }
  a->count -= whole;
  big_trim(a);
}
static inline uint32_t big_bits(const big *a) {
  if (a->count == 0) return 0;
  return 32u * a->count - (uint32_t)__builtin_clz(a->limb[a->count - 1u]);
}
static inline uint32_t big_zeros(const big *a) { /* at the low end; a is not 0 */
  uint32_t n = 0;
  while (a->limb[n] == 0) ++n;
  return 32u * n + (uint32_t)__builtin_ctz(a->limb[n]);
}

/* The greatest common divisor; 0 where both are. */
static inline void big_divisor(big *to, const big *a, const big *b) {
  static big x, y;
  big_copy(&x, a);
  big_copy(&y, b);
  x.sign = x.sign != 0;
  y.sign = y.sign != 0;
  if (x.sign == 0 || y.sign == 0) {
    big_copy(to, x.sign == 0 ? &y : &x);
    return;
  }
  const uint32_t zx = big_zeros(&x);
  const uint32_t zy = big_zeros(&y);
  big_shift_right(&x, zx);
  big_shift_right(&y, zy);
  for (int order = big_compare_sizes(&x, &y); order != 0; order = big_compare_sizes(&x, &y)) {
    big *more = order > 0 ? &x : &y;
    big_subtract(more, more, order > 0 ? &y : &x);
    big_shift_right(more, big_zeros(more));
  }
  big_shift_left(&x, zx < zy ? zx : zy);
  big_copy(to, &x);
}

/* a / b, where b divides a. */
static inline void big_divide(big *a, const big *b) {
  static big rest, part, quotient;
  big_copy(&rest, a);
  rest.sign = rest.sign != 0;
  big_set(&quotient, 0);
  while (rest.sign > 0) {
    uint32_t shift = big_bits(&rest) - big_bits(b);
    big_copy(&part, b);
    part.sign = 1;
    big_shift_left(&part, shift);
    if (big_compare_sizes(&part, &rest) > 0) {
      big_shift_right(&part, 1);
      --shift;
    }
    big_subtract(&rest, &rest, &part);
    big_set(&part, 1);
    big_shift_left(&part, shift);
    big_add(&quotient, &quotient, &part);
  }
  quotient.sign *= a->sign * b->sign;
  big_copy(a, &quotient);
}

#endif
