/* SPDX-License-Identifier: Apache-2.0 */
/* The phases of the force with which two hands tear a cloth, on forces made by hand. */
#include "tests/lib/test.h"

#include <math.h>
#include <string.h>

#include "tools/analysis/tear_force.h"

enum { TICKS = 1000, FIRST = 200, LAST = 800 };
static tear_force_sample samples[TICKS];

static int near(double a, double b) { return fabs(a - b) <= 1e-4 * (1 + fabs(b)); }

/* Rises by 2 N/cm to 4 N along y, then 1 N by turns 10 % less and more; the right hand has the opposite. */
static void make(void) {
  memset(samples, 0, sizeof samples);
  for (int n = 0; n < TICKS; ++n) {
    tear_force_sample *s = &samples[n];
    s->apart = 3 + 0.01f * (float)n;
    s->force[0][1] = n <= FIRST ? 0.02f * (float)n : n > LAST ? 0 : n % 2 != 0 ? 0.9f : 1.1f;
    s->force[1][1] = -s->force[0][1];
    s->force[0][0] = 0.1f;
    s->tears = n == FIRST || n == LAST || n == 500;
  }
}

static void phases_are_found(void) {
  tear_force f;
  make();
  CHECK(tear_force_measure(samples, TICKS, &f));
  CHECK_EQ_INT(f.axis, 1);
  CHECK_EQ_INT((long long)f.first, FIRST);
  CHECK_EQ_INT((long long)f.last, LAST);
  CHECK(near(f.unbalanced, 0));
  for (int h = 0; h < FRAY_HANDS; ++h) {
    const tear_force_hand *one = &f.hand[h];
    CHECK(near(one->rise, 2) && near(one->rise_r2, 1));
    CHECK(near(one->peak, 4) && one->peak_at == FIRST);
    CHECK(near(one->plateau, 1) && near(one->variation, 0.1));
  }
}

/* A rise that is no line, a hand that feels half, a plateau that is none. */
static void what_is_off_is_seen(void) {
  tear_force f;
  make();
  for (int n = 0; n <= FIRST; ++n) samples[n].force[0][1] = 4 * powf((float)n / FIRST, 4);
  for (int n = 0; n < TICKS; ++n) samples[n].force[1][1] /= 2;
  for (int n = FIRST + 1; n <= LAST; ++n) samples[n].force[0][1] = n % 2 != 0 ? 0.2f : 1.8f;
  CHECK(tear_force_measure(samples, TICKS, &f));
  CHECK(f.hand[0].rise_r2 < 0.98);
  CHECK(f.hand[0].variation > 0.7);
  CHECK(f.unbalanced > 0.1);
}

static void nothing_is_found_where_nothing_tears(void) {
  tear_force f;
  make();
  for (int n = 0; n < TICKS; ++n) samples[n].tears = 0;
  CHECK(!tear_force_measure(samples, TICKS, &f));
  samples[3].tears = 1; /* before there is a rise */
  CHECK(!tear_force_measure(samples, TICKS, &f));
  CHECK(!tear_force_measure(samples, 0, &f));
  make(); /* the force had fallen again before the first tear */
  for (int n = FIRST / 2; n <= FIRST; ++n) samples[n].force[0][1] = 0.5f;
  CHECK(!tear_force_measure(samples, TICKS, &f));
}

int main(void) {
  TEST(phases_are_found);
  TEST(what_is_off_is_seen);
  TEST(nothing_is_found_where_nothing_tears);
  return test_end();
}
