/* SPDX-License-Identifier: Apache-2.0 */
/* The effective mass of a constraint is 2^40 / k, floored, for inverse masses k of every size; above 32 bits
 * it is that of k without its low byte. Under FRAY_CHECKED no division leaves its range. */
#include "rt/elastic/step_impulse.h"
#include "tests/lib/splitmix64.h"
#include "tests/lib/test.h"

static void check_mass(uint64_t k) {
  const uint64_t one = (uint64_t)1 << 40;
  const uint64_t mass = k > UINT32_MAX ? one / (k >> 8) >> 8 : one / k;
  CHECK_EQ_INT(step_mass_of(k), mass > INT32_MAX ? INT32_MAX : (int64_t)mass);
}

static void masses_are_those_of_a_division(void) {
  uint64_t seed = 1;
  for (unsigned bit = 0; bit < 39; ++bit) {
    const uint64_t first = (uint64_t)1 << bit;
    check_mass(first);
    check_mass(2 * first - 1);
    for (unsigned n = 0; n < 10000; ++n) check_mass(first + (splitmix64(&seed) & (first - 1)));
  }
}

int main(void) {
  TEST(masses_are_those_of_a_division);
  return test_end();
}
