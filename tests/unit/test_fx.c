/* SPDX-License-Identifier: Apache-2.0 */
/* Fixed point: rounding and saturation over all of small ranges, roots over their whole range. */
#include <math.h>
#include <stdlib.h>

#include "rt/base/fx.h"
#include "rt/base/vec.h"
#include "tests/lib/splitmix64.h"
#include "tests/lib/test.h"

/* By division: floor, and nearest with halves away from zero. */
static int64_t floor_of(int64_t v, int64_t unit) {
  return v >= 0 ? v / unit : -((-v + unit - 1) / unit);
}
static int64_t nearest(int64_t v, int64_t unit) {
  return v >= 0 ? (v + unit / 2) / unit : -((-v + unit / 2) / unit);
}

static void literals(void) {
  CHECK_EQ_INT(fx_asr(-1, 1), -1);
  CHECK_EQ_INT(fx_asr(-1, 31), -1);
  CHECK_EQ_INT(fx_asr(7, 1), 3);
  CHECK_EQ_INT(fx_asr(INT32_MIN, 31), -1);
  CHECK_EQ_INT(fx_asr64(INT64_MIN, 63), -1);
  CHECK_EQ_INT(fx_round(8, 4), 1);
  CHECK_EQ_INT(fx_round(7, 4), 0);
  CHECK_EQ_INT(fx_round(-8, 4), -1);
  CHECK_EQ_INT(fx_round(-7, 4), 0);
  CHECK_EQ_INT(fx_round(24, 4), 2);
  CHECK_EQ_INT(fx_round(-24, 4), -2);
  CHECK_EQ_INT(fx_round64((int64_t)3 << 39, 40), 2);
  CHECK_EQ_INT(fx_round64(-((int64_t)3 << 39), 40), -2);
  CHECK_EQ_INT(fx_mul_q15(32767, 32767), 32766);
  CHECK_EQ_INT(fx_mul_q15(-32768, 32767), -32767);
  CHECK_EQ_INT(fx_mul_q15(1, 16384), 1);   /* half up */
  CHECK_EQ_INT(fx_mul_q15(-1, 16384), 0);  /* half up */
  CHECK_EQ_INT(fx_wrap_add(INT32_MAX, 1), INT32_MIN);
  CHECK_EQ_INT(fx_wrap_sub(INT32_MIN, 1), INT32_MAX);
  CHECK_EQ_INT(fx_wrap_shift(-1, 31), INT32_MIN);
}

static void rounding_is_right_for_every_small_number(void) {
  for (int32_t v = -9000; v <= 9000; ++v)
    for (unsigned s = 1; s <= 14; ++s) {
      CHECK_EQ_INT(fx_asr(v, s), floor_of(v, (int64_t)1 << s));
      CHECK_EQ_INT(fx_asr64(v, s), floor_of(v, (int64_t)1 << s));
      CHECK_EQ_INT(fx_round(v, s), nearest(v, (int64_t)1 << s));
      CHECK_EQ_INT(fx_round(v, s), -fx_round(-v, s));
      CHECK_EQ_INT(fx_round64(v, s), nearest(v, (int64_t)1 << s));
    }
  /* the same near the ends of the type, as far as the half fits */
  for (unsigned s = 1; s <= 30; ++s)
    for (int32_t n = 0; n < 2000; ++n) {
      const int32_t v = INT32_MAX - (int32_t)(1u << (s - 1)) - n;
      CHECK_EQ_INT(fx_round(v, s), nearest(v, (int64_t)1 << s));
      CHECK_EQ_INT(fx_round(-v, s), -nearest(v, (int64_t)1 << s));
      CHECK_EQ_INT(fx_asr(-v, s), floor_of(-(int64_t)v, (int64_t)1 << s));
    }
}

static void saturations_hold_at_their_edges(void) {
  static const int64_t edges[] = {0, INT16_MIN, INT16_MAX, INT32_MIN, INT32_MAX, UINT32_MAX};
  for (uint32_t e = 0; e < 6; ++e)
    for (int64_t v = edges[e] - 300; v <= edges[e] + 300; ++v) {
      const int64_t expected = v > 2147483647 ? 2147483647 : (v < -2147483647 ? -2147483647 : v);
      CHECK_EQ_INT(fx_saturate(v), expected);
      CHECK_EQ_INT(fx_saturate(-v), -expected);
      for (int32_t limit = INT32_MAX; limit > 0; limit /= 77) {
        CHECK_EQ_INT(fx_clamp_wide(v, limit), fx_clamp64(v, -(int64_t)limit, limit));
        CHECK_EQ_INT(fx_clamp_wide(v * 65536, limit), fx_clamp64(v * 65536, -(int64_t)limit, limit));
      }
      if (v < INT32_MIN || v > INT32_MAX) continue;
      const int32_t w = (int32_t)v;
      CHECK_EQ_INT(fx_magnitude(w), v < 0 ? -v : v);
      CHECK_EQ_INT(fx_clamp(w, -5, 9), w < -5 ? -5 : (w > 9 ? 9 : w));
      CHECK_EQ_INT(fx_min(w, 17), w < 17 ? w : 17);
      CHECK_EQ_INT(fx_max(w, 17), w > 17 ? w : 17);
    }
  CHECK_EQ_INT(fx_saturate(INT64_MAX), INT32_MAX);
  CHECK_EQ_INT(fx_saturate(INT64_MIN), -INT32_MAX);
  CHECK_EQ_INT(fx_clamp64(INT64_MIN, -3, 3), -3);
  CHECK_EQ_INT(fx_clamp64(INT64_MAX, -3, 3), 3);
}

/* Largest relative error of 1/sqrt over mantissas 2^30 .. 2^32, every 257th: 12.5 million. */
static double largest_error(int steps) {
  double most = 0;
  for (uint64_t m = (uint64_t)1 << 30; m < (uint64_t)1 << 32; m += 257) {
    const fx_root r = fx_rsqrt(m << 32, steps);
    if (r.m != m || r.h != 31) return 1;
    const double error = fabs((double)r.inverse * 0x1p-31 * sqrt((double)m * 0x1p-30) - 1);
    if (error > most) most = error;
  }
  return most;
}

static void roots_are_as_fine_as_promised(void) {
  const double fine = largest_error(FX_ROOT_FINE);
  const double coarse = largest_error(FX_ROOT_COARSE);
  printf("figure rsqrt_fine_error 2^%.2f relative (asked: below 2^-28)\n", log2(fine));
  printf("figure rsqrt_coarse_error 2^%.2f relative (asked: below 2^-19)\n", log2(coarse));
  CHECK(fine < 0x1p-28);
  CHECK(coarse < 0x1p-19);
}

/* n = m * 2^(2h - 30), with all of n's leading bits in m. */
static void roots_are_normalised(void) {
  for (unsigned bit = 0; bit < 64; ++bit) {
    const uint64_t n = (uint64_t)1 << bit | (uint64_t)1 << bit >> 3;
    const fx_root r = fx_rsqrt(n, FX_ROOT_FINE);
    CHECK(r.m >= 0x40000000u);
    CHECK_EQ_INT(r.h, bit / 2);
    CHECK(fabs(ldexp(r.m, 2 * (int)r.h - 30) / (double)n - 1) < 0x1p-30);
  }
}

/* Rounded down, with the inverse's error of 2^-28 and the 2^-31 that m cuts from n. */
static void lengths_are_within_their_error(void) {
  uint64_t seed = 1;
  double most = 0;
  for (uint64_t n = 1; n < 100000; ++n) {
    const double exact_root = sqrt((double)n);
    const double root = fx_root_length(fx_rsqrt(n, FX_ROOT_FINE));
    CHECK(root <= exact_root * (1 + 0x1p-28) && root > exact_root * (1 - 0x1p-27) - 1);
  }
  for (uint32_t trial = 0; trial < 1000000; ++trial) {
    const uint64_t n = (splitmix64(&seed) >> (trial % 64)) | 1u;
    const double exact_root = sqrt((double)n);
    const double away = fx_root_length(fx_rsqrt(n, FX_ROOT_FINE)) - exact_root;
    CHECK(away <= exact_root * 0x1p-28 && away > -exact_root * 0x1p-27 - 1);
    if (exact_root > 1e9 && fabs(away) / exact_root > most) most = fabs(away) / exact_root;
  }
  printf("figure root_length_error %.3g relative (asked: below 2^-27)\n", most);
}

/* Unit vectors of random integer vectors: each component within 2^-27 of 1, the length too; odd. */
static void units_are_within_their_error(void) {
  uint64_t seed = 2;
  double most = 0;
  for (uint32_t trial = 0; trial < 1000000; ++trial) {
    const unsigned s = trial % 31;
    const vec3 v = vec_make((int32_t)(splitmix64(&seed) & 0x7FFFFFFFu) >> s,
                            (int32_t)(splitmix64(&seed) & 0x7FFFFFFFu) >> (s / 2),
                            (int32_t)(splitmix64(&seed) & 0x7FFFFFFFu) >> s);
    const uint64_t n = vec_squared(v);
    if (n == 0) continue;
    const fx_root r = fx_rsqrt(n, FX_ROOT_FINE);
    const double length = sqrt((double)v.x * v.x + (double)v.y * v.y + (double)v.z * v.z);
    const int32_t parts[3] = {v.x, v.y, v.z};
    for (uint32_t k = 0; k < 3; ++k) {
      const int32_t unit = fx_root_unit(r, parts[k]);
      const double error = fabs(unit * 0x1p-30 - parts[k] / length);
      if (error > most) most = error;
      CHECK_EQ_INT(fx_root_unit(r, -parts[k]), -unit);
      CHECK(unit <= 1 << 30 && unit >= 0);
    }
  }
  printf("figure root_unit_error 2^%.2f (asked: below 2^-28 + 2^-30)\n", log2(most));
  CHECK(most < 0x1p-28 + 0x1p-31 + 0x1p-31);
}

static uint64_t seed = 88172645463325252u;

static void quotients_by_roots_are_near(void) {
  double most = 0;
  for (uint32_t trial = 0; trial < 1000000; ++trial) {
    const uint64_t n = (splitmix64(&seed) >> (trial % 64)) | 1u;
    const int32_t v = (int32_t)(splitmix64(&seed) >> (33 + trial % 23));
    const unsigned bits = trial % 31;
    const fx_root r = fx_rsqrt(n, FX_ROOT_FINE);
    const double exact = ldexp(v / sqrt((double)n), (int)bits);
    const double off = fabs((double)fx_root_over(r, v, bits) - exact) - 0.5;
    if (off > most * exact) most = off / exact;
    CHECK(fx_root_over(r, -v, bits) == -fx_root_over(r, v, bits));
  }
  printf("figure root_over_error 2^%.2f and half a step (asked: below 2^-28)\n", log2(most));
  CHECK(most < 0x1p-28);
}

/* The definition, in 64 bits, of what fx_rsqrt() does with factors of 32. */
static uint32_t wide_inverse(uint32_t m, int steps) {
  uint64_t y = m < 0x80000000u ? 2716337504u - (((uint64_t)m * 616403730u) >> 30)
                               : 1922456487u - (((uint64_t)m * 217931629u) >> 30);
  for (int step = 0; step < steps; ++step) {
    const uint64_t squared = (y * y) >> 31;
    const uint64_t unity = ((uint64_t)m * squared) >> 30;
    y = (y * (3u * (uint64_t)0x80000000u - unity)) >> 32;
  }
  return (uint32_t)(y > 0x80000000u ? 0x80000000u : y);
}
static void roots_are_those_of_64_bits(void) {
  uint32_t different = 0;
  for (uint64_t m = (uint64_t)1 << 30; m < (uint64_t)1 << 32; m += 911)
    for (int steps = FX_ROOT_COARSE; steps <= FX_ROOT_FINE; ++steps)
      different += fx_rsqrt(m << 32, steps).inverse != wide_inverse((uint32_t)m, steps);
  CHECK_EQ_INT(different, 0);
}

static void quotients_are_those_of_a_division(void) {
  uint32_t different = 0;
  for (uint32_t n = 0; n < 2000000u; ++n) {
    const uint32_t d = ((uint32_t)(splitmix64(&seed) >> 33) >> (splitmix64(&seed) & 31u)) + 1u;
    uint64_t v = splitmix64(&seed) >> (splitmix64(&seed) & 63u);
    if (n % 3u == 0) v = (uint64_t)d * (uint32_t)splitmix64(&seed) + (n % 2u == 0 ? d - 1u : 0u);
    const uint64_t q = v / d;
    different += fx_divide_wide(v, d) != (q > UINT32_MAX ? UINT32_MAX : (uint32_t)q);
  }
  CHECK_EQ_INT(different, 0);
  CHECK(fx_divide_wide(UINT64_MAX, 1) == UINT32_MAX);
  CHECK_EQ_INT(fx_divide_wide(0, 0x80000000u), 0);
  CHECK(fx_divide_wide(((uint64_t)1 << 63) - 1u, 0x80000000u) == UINT32_MAX);
}

static void narrow_forms_are_the_plain_ones(void) {
  static const int32_t edges[] = {INT32_MIN, -INT32_MAX, -32769, -32768, -1, 0, 1, 32767, 32768,
                                  INT32_MAX};
  enum { EDGES = sizeof edges / sizeof edges[0] };
  for (uint32_t n = 0; n < 200000u; ++n) {
    const int32_t a = n < EDGES * EDGES ? edges[n / EDGES] : (int32_t)(uint32_t)splitmix64(&seed);
    const int32_t b = n < EDGES * EDGES ? edges[n % EDGES] : (int32_t)(uint32_t)splitmix64(&seed);
    CHECK(fx_add_saturated(a, b) == fx_saturate((int64_t)a + b));
    CHECK(fx_clamp_rare(a, -1000, 77) == fx_clamp(a, -1000, 77));
    CHECK(fx_saturate16(a) == fx_clamp(a, -32768, 32767));
    CHECK(fx_mul_wide(a, b) == (int64_t)a * b);
    CHECK(fx_mul_wide_u((uint32_t)a, (uint32_t)b) == (uint64_t)(uint32_t)a * (uint32_t)b);
    CHECK(fx_square(a) == (uint64_t)((int64_t)a * a));
  }
}

int main(void) {
  TEST(quotients_by_roots_are_near);
  TEST(literals);
  TEST(rounding_is_right_for_every_small_number);
  TEST(saturations_hold_at_their_edges);
  TEST(roots_are_as_fine_as_promised);
  TEST(roots_are_normalised);
  TEST(lengths_are_within_their_error);
  TEST(units_are_within_their_error);
  TEST(roots_are_those_of_64_bits);
  TEST(quotients_are_those_of_a_division);
  TEST(narrow_forms_are_the_plain_ones);
  return test_end();
}
