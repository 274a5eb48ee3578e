/* SPDX-License-Identifier: Apache-2.0 */
/* Continuous collisions against exact arithmetic: no contact is missed, none is reported late; false
 * alarms are counted, and how near they are. */
#include <math.h>

#include "rt/base/sweep.h"
#include "tests/lib/test.h"
#include "tests/oracle/pairs.h"
#include "tests/oracle/touching.h"

#ifndef SWEEP_FEWER
#define SWEEP_FEWER 1
#endif

/* The ways from t = 0 to t = time / 2^15, in 2^-15 of a step of position, so that they are whole. */
static void ways_until(way w[4], const sweep_point p[4], int32_t time) {
  for (uint32_t n = 0; n < 4; ++n) {
    const int32_t begin[3] = {p[n].begin.x, p[n].begin.y, p[n].begin.z};
    const int32_t end[3] = {p[n].end.x, p[n].end.y, p[n].end.z};
    for (uint32_t k = 0; k < 3; ++k) {
      w[n].begin[k] = (int64_t)begin[k] * SWEEP_ONE;
      w[n].end[k] = w[n].begin[k] + (int64_t)time * ((int64_t)end[k] - begin[k]);
    }
  }
}

static uint32_t missed_all, late_all, true_all, false_all, pairs_all;

static void print_pair(const char *what, const sweep_point p[4], int triangle) {
  printf("%s, %s:", what, triangle ? "point and triangle" : "edges");
  for (uint32_t n = 0; n < 4; ++n)
    printf(" {{%d, %d, %d}, {%d, %d, %d}}", p[n].begin.x, p[n].begin.y, p[n].begin.z, p[n].end.x,
           p[n].end.y, p[n].end.z);
  printf("\n");
}

static void try_family(const family_row *row, int triangle) {
  uint32_t found = 0;
  uint32_t reported = 0;
  uint32_t missed = 0;
  uint32_t late = 0;
  for (uint32_t n = 0; n < row->pairs / SWEEP_FEWER; ++n) {
    sweep_point p[4];
    way w[4];
    sweep_contact c;
    row->make(p, triangle);
    ways_until(w, p, SWEEP_ONE);
    const int is = touching(w, triangle);
    const int says = sweep_pair(p, triangle, 0, &c);
    found += (uint32_t)is;
    reported += (uint32_t)says;
    if (is && !says && missed++ < 3) print_pair("missed", p, triangle);
    if (!is || !says || c.time == 0 || n % 4u != 0) continue;
    ways_until(w, p, c.time - 1);
    if (touching(w, triangle) && late++ < 3) print_pair("late", p, triangle);
  }
  printf("figure sweep_%s_%s %u pairs, %u touch, %u missed, %u late, %u false alarms\n",
         triangle ? "triangle" : "edges", row->name, row->pairs / SWEEP_FEWER, found, missed, late,
         reported - found + missed);
  missed_all += missed;
  late_all += late;
  true_all += found;
  false_all += reported - found + missed;
  pairs_all += row->pairs / SWEEP_FEWER;
}

static void no_touch_is_missed(void) {
  for (uint32_t n = 0; n < FAMILIES; ++n)
    for (int triangle = 0; triangle < 2; ++triangle) try_family(&families[n], triangle);
  printf("figure sweep_all %u pairs, %u touch, %u missed, %u late, %u false alarms\n", pairs_all,
         true_all, missed_all, late_all, false_all);
  CHECK_EQ_INT(missed_all, 0);
  CHECK_EQ_INT(late_all, 0);
}

int main(void) {
  TEST(no_touch_is_missed);
  return test_end();
}
