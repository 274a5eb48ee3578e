/* SPDX-License-Identifier: Apache-2.0 */
#include <stdint.h>

#include "tests/lib/test.h"
#include "tools/scene_language/angle.h"
#include "tools/scene_language/exact.h"
#include "tools/scene_language/number.h"

#define CHECK_EXACT(value, n, d) \
  do { \
    exact checked = (value); \
    CHECK_EQ_INT(checked.numerator, n); \
    CHECK_EQ_INT(checked.denominator, d); \
  } while (0)

static void makes_lowest_terms(void) {
  CHECK_EXACT(exact_make(6, 8), 3, 4);
  CHECK_EXACT(exact_make(6, -8), -3, 4);
  CHECK_EXACT(exact_make(-6, -8), 3, 4);
  CHECK_EXACT(exact_make(0, -5), 0, 1);
  CHECK_EXACT(exact_make(INT64_MIN, 2), INT64_MIN / 2, 1);
  CHECK_EXACT(exact_make(INT64_MIN, 1), INT64_MIN, 1);
  CHECK_EXACT(exact_make(INT64_MIN, INT64_MIN), 1, 1);
  CHECK(!exact_valid(exact_make(1, 0)));
  CHECK(!exact_valid(exact_make(INT64_MIN, -1)));
  CHECK(!exact_valid(exact_make(1, INT64_MIN)));
}

static void computes(void) {
  exact third = exact_make(1, 3), half = exact_make(1, 2);
  CHECK_EXACT(exact_add(third, half), 5, 6);
  CHECK_EXACT(exact_sub(third, half), -1, 6);
  CHECK_EXACT(exact_mul(third, half), 1, 6);
  CHECK_EXACT(exact_div(third, half), 2, 3);
  CHECK_EXACT(exact_div(third, exact_make(-1, 2)), -2, 3);
  CHECK_EXACT(exact_add(exact_make(1, 6), exact_make(1, 10)), 4, 15);
  CHECK_EXACT(exact_sub(third, third), 0, 1);
  CHECK_EXACT(exact_mul(exact_make(INT64_MAX, 3), exact_make(3, INT64_MAX)), 1, 1);
  CHECK_EXACT(exact_sub(exact_make(INT64_MIN, 1), exact_make(INT64_MIN, 1)), 0, 1);
  /* numerators of 126 bits that shrink again */
  int64_t prime = INT64_C(9223372036854775783);
  CHECK_EXACT(exact_add(exact_make(prime - 1, prime), exact_make(1, prime)), 1, 1);
}

static void passes_overflow_on(void) {
  exact big = exact_make(INT64_MAX, 1), tiny = exact_make(1, INT64_MAX);
  exact bad = exact_mul(big, big);
  CHECK(!exact_valid(bad));
  CHECK(!exact_valid(exact_mul(tiny, tiny)));
  CHECK(!exact_valid(exact_add(big, big)));
  CHECK(!exact_valid(exact_div(big, tiny)));
  CHECK(!exact_valid(exact_div(big, exact_make(0, 1))));
  CHECK(!exact_valid(exact_add(bad, exact_make(1, 1))));
  CHECK(!exact_valid(exact_sub(exact_make(1, 1), bad)));
  CHECK(!exact_valid(exact_mul(exact_make(0, 1), bad)));
  CHECK(!exact_valid(exact_div(exact_make(0, 1), bad)));
}

static void compares(void) {
  CHECK_EQ_INT(exact_compare(exact_make(1, 3), exact_make(1, 2)), -1);
  CHECK_EQ_INT(exact_compare(exact_make(-1, 3), exact_make(-1, 2)), 1);
  CHECK_EQ_INT(exact_compare(exact_make(-1, 3), exact_make(1, 2)), -1);
  CHECK_EQ_INT(exact_compare(exact_make(0, 1), exact_make(-1, 2)), 1);
  CHECK_EQ_INT(exact_compare(exact_make(2, 4), exact_make(1, 2)), 0);
  CHECK_EQ_INT(exact_compare(exact_make(INT64_MAX, INT64_MAX - 1),
                             exact_make(INT64_MAX - 1, INT64_MAX - 2)), -1);
  CHECK_EQ_INT(exact_compare(exact_make(INT64_MIN, 1), exact_make(INT64_MIN, 3)), -1);
}

static void rounds_to_fixed(void) {
  int64_t r = 0;
  CHECK(exact_to_fixed(exact_make(1, 2), 0, &r));
  CHECK_EQ_INT(r, 1);
  CHECK(exact_to_fixed(exact_make(-1, 2), 0, &r));
  CHECK_EQ_INT(r, -1);
  CHECK(exact_to_fixed(exact_make(49, 100), 0, &r));
  CHECK_EQ_INT(r, 0);
  CHECK(exact_to_fixed(exact_make(1, 12), 24, &r));
  CHECK_EQ_INT(r, 1398101);
  CHECK(exact_to_fixed(exact_make(1, 1), 62, &r));
  CHECK_EQ_INT(r, INT64_C(1) << 62);
  CHECK(exact_to_fixed(exact_make(INT64_MAX, 1), 0, &r));
  CHECK_EQ_INT(r, INT64_MAX);
  CHECK(exact_to_fixed(exact_make(-2, 1), 62, &r));
  CHECK_EQ_INT(r, INT64_MIN);
  CHECK(exact_to_fixed(exact_make(INT64_MAX, INT64_MAX - 1), 62, &r));
  CHECK_EQ_INT(r, (INT64_C(1) << 62) + 1);
  CHECK(!exact_to_fixed(exact_make(2, 1), 62, &r));
  CHECK(!exact_to_fixed(exact_make(INT64_MAX, 1), 62, &r));
  CHECK(!exact_to_fixed(exact_make(1, 1), 63, &r));
  CHECK(!exact_to_fixed(exact_make(1, 0), 1, &r));
}

static void multiplies_and_divides(void) {
  int64_t r = 0;
  CHECK(exact_mul_div(7, 5, 2, &r));
  CHECK_EQ_INT(r, 18);
  CHECK(exact_mul_div(-7, 5, 2, &r));
  CHECK_EQ_INT(r, -18);
  CHECK(exact_mul_div(INT64_MAX, INT64_MAX, INT64_MAX, &r));
  CHECK_EQ_INT(r, INT64_MAX);
  CHECK(exact_mul_div(INT64_MIN, INT64_MAX, INT64_MAX, &r));
  CHECK_EQ_INT(r, INT64_MIN);
  CHECK(exact_mul_div(INT64_C(1000000000000), INT64_C(3000000000000), INT64_C(7000000000000), &r));
  CHECK_EQ_INT(r, INT64_C(428571428571));
  CHECK(!exact_mul_div(INT64_MAX, 2, 1, &r));
  CHECK(!exact_mul_div(INT64_MIN, -1, 1, &r));
  CHECK(!exact_mul_div(1, 1, 0, &r));
}

static void takes_roots(void) {
  CHECK_EQ_INT(exact_sqrt(0), 0);
  CHECK_EQ_INT(exact_sqrt(3), 1);
  CHECK_EQ_INT(exact_sqrt(4), 2);
  CHECK_EQ_INT(exact_sqrt(UINT64_MAX), UINT32_MAX);
  for (uint64_t n = 1; n < UINT32_MAX; n = n * 3 + 1) {
    CHECK_EQ_INT(exact_sqrt(n * n), n);
    CHECK_EQ_INT(exact_sqrt(n * n - 1), n - 1);
  }
}

static void check_number(const char *text, number_status status, int64_t n, int64_t d,
                         size_t used_wanted) {
  exact value;
  size_t used;
  CHECK_EQ_INT(number_read(text, strlen(text), &value, &used), status);
  CHECK_EQ_INT(used, used_wanted);
  if (status == NUMBER_GOOD) CHECK_EXACT(value, n, d);
}

static void reads_numbers(void) {
  check_number("0.25", NUMBER_GOOD, 1, 4, 4);
  check_number("-981", NUMBER_GOOD, -981, 1, 4);
  check_number("1e-3", NUMBER_GOOD, 1, 1000, 4);
  check_number("+2.50E2cm", NUMBER_GOOD, 250, 1, 7);
  check_number("10%", NUMBER_GOOD, 10, 1, 2);
  check_number(".5", NUMBER_GOOD, 1, 2, 2);
  check_number("5e", NUMBER_GOOD, 5, 1, 1);
  check_number("5e+", NUMBER_GOOD, 5, 1, 1);
  check_number("-0", NUMBER_GOOD, 0, 1, 2);
  check_number("999999999999999999", NUMBER_GOOD, INT64_C(999999999999999999), 1, 18);
  check_number("0.000000000000000001", NUMBER_LONG, 0, 0, 20);
  check_number("1000000000000000000", NUMBER_LONG, 0, 0, 19);
  check_number("1e19", NUMBER_EXTREME, 0, 0, 4);
  check_number("10e18", NUMBER_EXTREME, 0, 0, 5);
  check_number("1e99999999999999999999", NUMBER_EXTREME, 0, 0, 22);
  check_number("0.1e-18", NUMBER_EXTREME, 0, 0, 7);
  check_number("", NUMBER_NONE, 0, 0, 0);
  check_number("-", NUMBER_NONE, 0, 0, 0);
  check_number(".", NUMBER_NONE, 0, 0, 0);
  check_number("e5", NUMBER_NONE, 0, 0, 0);
}

/* tan(15 deg) = 2 - sqrt 3, tan(22.5 deg) = sqrt 2 - 1: times 4096, rounded by hand. */
static void halves_angles(void) {
  CHECK_EXACT(angle_half_tangent(exact_make(0, 1)), 0, 1);
  CHECK_EXACT(angle_half_tangent(exact_make(90, 1)), 1, 1);
  CHECK_EXACT(angle_half_tangent(exact_make(-90, 1)), -1, 1);
  CHECK_EXACT(angle_half_tangent(exact_make(30, 1)), 549, 2048);
  CHECK_EXACT(angle_half_tangent(exact_make(45, 1)), 1697, 4096);
  CHECK_EXACT(angle_half_tangent(exact_make(170, 1)), 46817, 4096);
}

int main(void) {
  TEST(makes_lowest_terms);
  TEST(computes);
  TEST(passes_overflow_on);
  TEST(compares);
  TEST(rounds_to_fixed);
  TEST(multiplies_and_divides);
  TEST(takes_roots);
  TEST(reads_numbers);
  TEST(halves_angles);
  return test_end();
}
