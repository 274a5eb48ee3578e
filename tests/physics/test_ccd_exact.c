/* SPDX-License-Identifier: Apache-2.0 */
/* Continuous collisions against exact arithmetic: no contact is missed, none is reported late;
 * false alarms are counted, and how near they are. */
#include "tests/lib/test.h"
#include "tests/physics/moving_distance.h"
#include "tests/physics/moving_pairs.h"
#include "tests/physics/exact_ccd.h"

/* The ways from t = 0 to t = time / 2^15, in 2^-15 of a step of position: whole numbers. */
static void points_until(moving_point w[4], const ccd_path p[4], int32_t time) {
  for (uint32_t n = 0; n < 4; ++n) {
    const int32_t begin[3] = {p[n].begin.x, p[n].begin.y, p[n].begin.z};
    const int32_t end[3] = {p[n].end.x, p[n].end.y, p[n].end.z};
    for (uint32_t k = 0; k < 3; ++k) {
      w[n].begin[k] = (int64_t)begin[k] * CCD_ONE;
      w[n].end[k] = w[n].begin[k] + (int64_t)time * ((int64_t)end[k] - begin[k]);
    }
  }
}

static uint32_t missed_all, late_all, true_all, false_all, pairs_all;

/* False alarms by how far apart the two stay, in shares of the extent of the pair. */
enum { SHARES = 5 };
static const char *const share_names[SHARES] = {"2^-16", "2^-12", "2^-10", "2^-8", "more"};
static uint32_t shares[SHARES];
static void count_share(double apart) {
  static const double most[SHARES] = {0x1p-16, 0x1p-12, 0x1p-10, 0x1p-8, 2};
  uint32_t n = 0;
  while (n + 1u < SHARES && apart > most[n]) ++n;
  ++shares[n];
}
static void print_shares(const char *name) {
  printf("figure %s false alarms, apart by at most", name);
  for (uint32_t n = 0; n < SHARES; ++n) {
    printf(" %s: %u", share_names[n], shares[n]);
    shares[n] = 0;
  }
  printf("\n");
}

static void print_pair(const char *what, const ccd_path p[4], int triangle) {
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
  const uint32_t pairs = (triangle ? row->points : row->edges) / TEST_FEWER;
  for (uint32_t n = 0; n < pairs; ++n) {
    ccd_path p[4];
    moving_point w[4];
    ccd_contact c;
    row->make(p, triangle);
    points_until(w, p, CCD_ONE);
    const int is = exact_ccd_touches(w, triangle);
    const int says = ccd_of_pair(p, triangle, 0, &c);
    found += (uint32_t)is;
    reported += (uint32_t)says;
    if (is && !says && missed++ < 3) print_pair("missed", p, triangle);
    if (says && !is) count_share(least_distance(p, triangle) / extent_of(p));
    if (!is || !says || c.time == 0 || n % 4u != 0) continue;
    points_until(w, p, c.time - 1);
    if (exact_ccd_touches(w, triangle) && late++ < 3) print_pair("late", p, triangle);
  }
  printf("figure sweep_%s_%s %u pairs, %u touch, %u missed, %u late, %u false alarms\n",
         triangle ? "triangle" : "edges", row->name, pairs, found, missed, late,
         reported - found + missed);
  missed_all += missed;
  late_all += late;
  true_all += found;
  false_all += reported - found + missed;
  pairs_all += pairs;
}

static void no_touch_is_missed(void) {
  for (uint32_t n = 0; n < FAMILIES; ++n)
    for (int triangle = 0; triangle < 2; ++triangle) try_family(&families[n], triangle);
  printf("figure sweep_all %u pairs, %u touch, %u missed, %u late, %u false alarms\n", pairs_all,
         true_all, missed_all, late_all, false_all);
  print_shares("sweep");
  CHECK_EQ_INT(missed_all, 0);
  CHECK_EQ_INT(late_all, 0);
  CHECK(false_all < true_all / 10);
}

/* With a thickness: what comes within it, by a witness in double with 1e-3 of a step to spare, is
 * reported, and not later than that; what does not and is reported is counted. */
static void no_approach_is_missed(void) {
  enum { PAIRS = 30000 / TEST_FEWER };
  static const uint32_t rows[] = {0, 1, 2, FAMILIES - 1};
  for (uint32_t at = 0; at < 4; ++at)
    for (int triangle = 0; triangle < 2; ++triangle) {
      const uint32_t row = rows[at];
      uint32_t near = 0;
      uint32_t missed = 0;
      uint32_t late = 0;
      uint32_t alarms = 0;
      for (uint32_t n = 0; n < PAIRS; ++n) {
        ccd_path p[4];
        ccd_contact c;
        families[row].make(p, triangle);
        const double extent = extent_of(p);
        const double least = least_distance(p, triangle);
        /* half of them about as thick as the two come near */
        const double wanted = pairs_below(2) == 0 ? least * (0.9 + 0.2 * pairs_below(1024) / 1024)
                                                  : extent * pairs_below(1024) / 4096;
        const int32_t thickness = clamp_to_world((int64_t)wanted);
        const int is = least < thickness - 1e-3;
        const int says = ccd_of_pair(p, triangle, thickness, &c);
        near += (uint32_t)is;
        missed += is && !says;
        if (says && least > thickness + 1e-3) {
          ++alarms;
          count_share((least - thickness) / extent);
        }
        for (int k = 0; says && c.time > 0 && k < 64; ++k)
          late += distance_at(p, triangle, c.time * (k / 64.0) / CCD_ONE) < thickness - 1e-3;
      }
      printf("figure sweep_thick_%s_%s %u pairs, %u near, %u missed, %u late, %u false alarms\n",
             triangle ? "triangle" : "edges", families[row].name, (uint32_t)PAIRS, near, missed,
             late, alarms);
      CHECK_EQ_INT(missed, 0);
      CHECK_EQ_INT(late, 0);
    }
  print_shares("sweep_thick");
}

int main(void) {
  TEST(no_touch_is_missed);
  TEST(no_approach_is_missed);
  return test_end();
}
