/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/scene_language/exact.h"

/* 128-bit magnitudes in two halves: 32-bit targets have no wider integer than 64 bits. */
typedef struct {
  uint64_t high, low;
} wide;

static const exact overflow = {0, 0};

/* clang's integer sanitizer flags unsigned wrap-around and lost bits; here they are intended. */
#if defined(__clang__)
#define WRAPS __attribute__((no_sanitize("integer")))
#else
#define WRAPS
#endif

static uint64_t magnitude(int64_t v) {
  return v < 0 ? (uint64_t)(-(v + 1)) + 1u : (uint64_t)v;
}

WRAPS static wide wide_product(uint64_t a, uint64_t b) {
  const uint64_t mask = 0xffffffffu;
  uint64_t low = (a & mask) * (b & mask);
  uint64_t cross = (a >> 32) * (b & mask) + (low >> 32);
  uint64_t other = (a & mask) * (b >> 32) + (cross & mask);
  wide p = {(a >> 32) * (b >> 32) + (cross >> 32) + (other >> 32), (other << 32) | (low & mask)};
  return p;
}

static int wide_compare(wide a, wide b) {
  if (a.high != b.high) return a.high < b.high ? -1 : 1;
  if (a.low != b.low) return a.low < b.low ? -1 : 1;
  return 0;
}

WRAPS static wide wide_sum(wide a, wide b) {
  wide s = {a.high + b.high, a.low + b.low};
  s.high += s.low < a.low;
  return s;
}

WRAPS static wide wide_difference(wide a, wide b) {
  wide d = {a.high - b.high - (a.low < b.low), a.low - b.low};
  return d;
}

/* divisor 1..2^63, so that a remainder doubled still fits. */
WRAPS static wide wide_divide(wide n, uint64_t divisor, uint64_t *remainder) {
  wide quotient = {0, 0};
  uint64_t rest = 0;
  if (n.high == 0) {
    quotient.low = n.low / divisor;
    *remainder = n.low % divisor;
    return quotient;
  }
  for (int bit = 127; bit >= 0; bit--) {
    uint64_t next = bit >= 64 ? (n.high >> (bit - 64)) & 1u : (n.low >> bit) & 1u;
    rest = rest << 1 | next;
    quotient.high = quotient.high << 1 | quotient.low >> 63;
    quotient.low <<= 1;
    if (rest >= divisor) {
      rest -= divisor;
      quotient.low |= 1u;
    }
  }
  *remainder = rest;
  return quotient;
}

static uint64_t common_divisor(uint64_t a, uint64_t b) {
  while (b != 0) {
    uint64_t rest = a % b;
    a = b;
    b = rest;
  }
  return a;
}

/* Writes -n or n. Returns 0 iff it leaves int64. */
static int signed_value(int negative, uint64_t n, int64_t *result) {
  if (n > (uint64_t)INT64_MAX + (negative ? 1u : 0u)) return 0;
  if (!negative) {
    *result = (int64_t)n;
  } else {
    *result = n > (uint64_t)INT64_MAX ? INT64_MIN : -(int64_t)n;
  }
  return 1;
}

static exact from_magnitudes(int negative, uint64_t numerator, uint64_t denominator) {
  exact result;
  if (denominator == 0 || denominator > (uint64_t)INT64_MAX) return overflow;
  if (!signed_value(negative, numerator, &result.numerator)) return overflow;
  result.denominator = (int64_t)denominator;
  return result;
}

int exact_valid(exact a) { return a.denominator > 0; }

exact exact_make(int64_t numerator, int64_t denominator) {
  uint64_t n = magnitude(numerator), d = magnitude(denominator);
  if (d == 0) return overflow;
  uint64_t divisor = common_divisor(n, d);
  return from_magnitudes((numerator < 0) != (denominator < 0), n / divisor, d / divisor);
}

exact exact_mul(exact a, exact b) {
  if (!exact_valid(a) || !exact_valid(b)) return overflow;
  uint64_t an = magnitude(a.numerator), bn = magnitude(b.numerator);
  uint64_t ad = (uint64_t)a.denominator, bd = (uint64_t)b.denominator;
  uint64_t first = common_divisor(an, bd), second = common_divisor(bn, ad);
  wide n = wide_product(an / first, bn / second);
  wide d = wide_product(ad / second, bd / first);
  if (n.high != 0 || d.high != 0) return overflow;
  return from_magnitudes((a.numerator < 0) != (b.numerator < 0), n.low, d.low);
}

exact exact_div(exact a, exact b) {
  if (!exact_valid(a) || !exact_valid(b) || b.numerator == 0) return overflow;
  uint64_t an = magnitude(a.numerator), bn = magnitude(b.numerator);
  uint64_t ad = (uint64_t)a.denominator, bd = (uint64_t)b.denominator;
  uint64_t first = common_divisor(an, bn), second = common_divisor(ad, bd);
  wide n = wide_product(an / first, bd / second);
  wide d = wide_product(ad / second, bn / first);
  if (n.high != 0 || d.high != 0) return overflow;
  return from_magnitudes((a.numerator < 0) != (b.numerator < 0), n.low, d.low);
}

/* Knuth, The Art of Computer Programming 2, 4.5.1: only the common divisor of the denominators
 * can divide both the sum and the common denominator. */
static exact sum_of(exact a, int flip_b, exact b) {
  if (!exact_valid(a) || !exact_valid(b)) return overflow;
  uint64_t ad = (uint64_t)a.denominator, bd = (uint64_t)b.denominator;
  uint64_t shared = common_divisor(ad, bd);
  int a_negative = a.numerator < 0, b_negative = (b.numerator < 0) != flip_b;
  wide x = wide_product(magnitude(a.numerator), bd / shared);
  wide y = wide_product(magnitude(b.numerator), ad / shared);
  int negative = a_negative;
  wide n;
  if (a_negative == b_negative) {
    n = wide_sum(x, y); /* each at most 2^126 */
  } else if (wide_compare(x, y) >= 0) {
    n = wide_difference(x, y);
  } else {
    n = wide_difference(y, x);
    negative = b_negative;
  }
  if (n.high == 0 && n.low == 0) return exact_make(0, 1);
  uint64_t rest;
  wide_divide(n, shared, &rest);
  uint64_t divisor = common_divisor(shared, rest);
  n = wide_divide(n, divisor, &rest);
  wide d = wide_product(ad / divisor, bd / shared);
  if (n.high != 0 || d.high != 0) return overflow;
  return from_magnitudes(negative, n.low, d.low);
}

exact exact_add(exact a, exact b) { return sum_of(a, 0, b); }

exact exact_sub(exact a, exact b) { return sum_of(a, 1, b); }

int exact_compare(exact a, exact b) {
  int a_negative = a.numerator < 0, b_negative = b.numerator < 0;
  if (a_negative != b_negative) return a_negative ? -1 : 1;
  wide x = wide_product(magnitude(a.numerator), (uint64_t)b.denominator);
  wide y = wide_product(magnitude(b.numerator), (uint64_t)a.denominator);
  return a_negative ? wide_compare(y, x) : wide_compare(x, y);
}

/* n / d to the nearest, halves up in magnitude. */
static int rounded(int negative, wide n, uint64_t d, int64_t *result) {
  uint64_t rest;
  wide quotient = wide_divide(n, d, &rest);
  if (quotient.high != 0) return 0;
  if (rest >= d - rest) {
    if (quotient.low == UINT64_MAX) return 0;
    quotient.low++;
  }
  return signed_value(negative, quotient.low, result);
}

int exact_to_fixed(exact a, unsigned shift, int64_t *result) {
  if (!exact_valid(a) || shift > 62u) return 0;
  wide n = wide_product(magnitude(a.numerator), (uint64_t)1 << shift);
  return rounded(a.numerator < 0, n, (uint64_t)a.denominator, result);
}

int exact_mul_div(int64_t a, int64_t b, int64_t c, int64_t *result) {
  if (c <= 0) return 0;
  wide n = wide_product(magnitude(a), magnitude(b));
  return rounded((a < 0) != (b < 0), n, (uint64_t)c, result);
}

uint32_t exact_sqrt(uint64_t n) {
  uint64_t root = 0;
  for (uint64_t bit = (uint64_t)1 << 31; bit != 0; bit >>= 1) {
    uint64_t tried = root | bit;
    if (tried * tried <= n) root = tried;
  }
  return (uint32_t)root;
}
