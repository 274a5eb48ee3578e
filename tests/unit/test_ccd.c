/* SPDX-License-Identifier: Apache-2.0 */
/* Continuous collisions by hand: times, places, normals, contacts that just are and just are not.
 * tests/physics/test_ccd_exact.c has the million. */
#include "rt/geometry/ccd.h"
#include "tests/lib/test.h"
#include "tests/physics/moving_pairs.h"

enum { UNIT = 1 << 20, FAR = FX_WORLD_MAX };

static ccd_contact contact;

static ccd_path still(int32_t x, int32_t y, int32_t z) {
  const ccd_path p = {{x, y, z}, {x, y, z}};
  return p;
}
static ccd_path moving(ccd_path p, int32_t x, int32_t y, int32_t z) {
  p.end = vec_add(p.begin, vec_make(x, y, z));
  return p;
}
static int edges(ccd_path a, ccd_path b, ccd_path c, ccd_path d, int32_t thickness) {
  const ccd_path first[2] = {a, b};
  const ccd_path second[2] = {c, d};
  return ccd_edges(first, second, thickness, &contact);
}
static int corner(ccd_path p, ccd_path a, ccd_path b, ccd_path c, int32_t thickness) {
  const ccd_path triangle[3] = {a, b, c};
  return ccd_point_triangle(&p, triangle, thickness, &contact);
}
static void check_time(int32_t wanted) { /* not later, and to 2^-11 of the step */
  CHECK(contact.time <= wanted);
  CHECK(contact.time >= wanted - 16);
}
static void check_near(int32_t v, int32_t wanted, int32_t most) {
  CHECK(v >= wanted - most && v <= wanted + most);
}
static void check_normal(int32_t x, int32_t y, int32_t z) {
  check_near(contact.normal.x, x, 1 << 18);
  check_near(contact.normal.y, y, 1 << 18);
  check_near(contact.normal.z, z, 1 << 18);
}

/* One along x, a quarter of it left of the other, which comes down along z. */
static void edges_cross(void) {
  const ccd_path a = still(-UNIT, 0, 0);
  const ccd_path b = still(3 * UNIT, 0, 0);
  const ccd_path c = moving(still(0, -UNIT, UNIT), 0, 0, -2 * UNIT);
  const ccd_path d = moving(still(0, UNIT, UNIT), 0, 0, -2 * UNIT);
  CHECK(edges(a, b, c, d, 0));
  check_time(CCD_ONE / 2);
  check_near(contact.weight[0], CCD_ONE / 4, 4);
  check_near(contact.weight[1], CCD_ONE / 2, 4);
  check_normal(0, 0, 1 << 30);
  CHECK(edges(a, b, c, d, UNIT / 2));
  check_time(CCD_ONE / 4);
  check_normal(0, 0, 1 << 30);
  CHECK(edges(c, d, a, b, 0));
  check_time(CCD_ONE / 2);
  check_near(contact.weight[1], CCD_ONE / 4, 4);
  check_normal(0, 0, -(1 << 30));
}
static void edges_pass(void) {
  const ccd_path c = moving(still(0, -UNIT, UNIT), 0, 0, -2 * UNIT);
  const ccd_path d = moving(still(0, UNIT, UNIT), 0, 0, -2 * UNIT);
  CHECK(!edges(still(UNIT / 1000, 0, 0), still(3 * UNIT, 0, 0), c, d, 0));
  CHECK(edges(still(0, 0, 0), still(3 * UNIT, 0, 0), c, d, 0));
  CHECK_EQ_INT(contact.weight[0], 0);
  /* by the end of one, within the thickness */
  CHECK(edges(still(UNIT / 10, 0, 0), still(3 * UNIT, 0, 0), c, d, UNIT / 9));
  CHECK(!edges(still(UNIT / 9, 0, 0), still(3 * UNIT, 0, 0), c, d, UNIT / 10));
}
/* Exactly at the thickness, at the end of the step only, and one step of position less. */
static void the_last_moment_counts(void) {
  for (int32_t h = 0; h < 100000; h += 7919)
    for (int32_t less = 0; less < 2; ++less) {
      const int32_t by = -(2 * UNIT - h) + less;
      const ccd_path c = moving(still(0, -UNIT, 2 * UNIT), 0, 0, by);
      const ccd_path d = moving(still(0, UNIT, 2 * UNIT), 0, 0, by);
      const ccd_path c_back = {c.end, c.begin};
      const ccd_path d_back = {d.end, d.begin};
      CHECK_EQ_INT(edges(still(-UNIT, 0, 0), still(UNIT, 0, 0), c, d, h), less == 0);
      if (less == 0) check_time(CCD_ONE);
      CHECK_EQ_INT(edges(still(-UNIT, 0, 0), still(UNIT, 0, 0), c_back, d_back, h), less == 0);
      if (less == 0) CHECK_EQ_INT(contact.time, 0);
    }
}
/* The ends are (3, 4, 12) h / 13 apart: h. */
static void corners_are_round(void) {
  const ccd_path a = still(-UNIT, -UNIT, -UNIT);
  const ccd_path o = still(0, 0, 0);
  for (int32_t k = 1000; k < UNIT / 16; k = 3 * k + 1) {
    const ccd_path c = still(3 * k, 4 * k, 12 * k);
    const ccd_path d = still(UNIT, UNIT + 1, UNIT + 2);
    CHECK(edges(a, o, c, d, 13 * k));
    CHECK(!edges(a, o, c, d, 13 * k - k / 500 - 1));
    CHECK(corner(o, c, d, still(UNIT, 2 * UNIT, UNIT), 13 * k));
    CHECK(!corner(o, c, d, still(UNIT, 2 * UNIT, UNIT), 13 * k - k / 500 - 1));
  }
}
static void what_is_degenerate_touches(void) {
  const ccd_path o = still(0, 0, 0);
  const ccd_path x = still(UNIT, 0, 0);
  CHECK(edges(o, o, o, o, 0)); /* points */
  CHECK_EQ_INT(contact.time, 0);
  check_normal(0, 1 << 30, 0);
  CHECK(!edges(o, o, x, x, 0));
  CHECK(edges(o, x, moving(x, -1, 0, 0), still(2 * UNIT, 0, 0), 0)); /* along each other */
  CHECK(!edges(o, x, still(UNIT + 1, 0, 0), still(2 * UNIT, 0, 0), 0));
  /* one comes to lie along the other, at the end of the step */
  CHECK(edges(o, x, moving(still(UNIT / 2, UNIT, 0), 0, -UNIT, 0),
              moving(still(3 * UNIT, UNIT, 0), 0, -UNIT, 0), 0));
  check_time(CCD_ONE);
  check_normal(0, 1 << 30, 0);
  /* a point that crosses an edge, in a plane; and one that crosses a point */
  const ccd_path across = moving(still(UNIT / 4, 3, 0), 0, -6, 0);
  CHECK(edges(o, x, across, across, 0));
  check_near(contact.weight[0], CCD_ONE / 4, 2);
  CHECK(corner(moving(still(-UNIT, 0, 0), 2 * UNIT, 0, 0), o, o, o, 0));
  check_time(CCD_ONE / 2);
  check_normal(1 << 30, 0, 0);
}
static void a_point_meets_a_triangle(void) {
  const ccd_path a = still(0, 0, 0);
  const ccd_path b = still(4 * UNIT, 0, 0);
  const ccd_path c = still(0, 4 * UNIT, 0);
  const ccd_path p = moving(still(UNIT, 2 * UNIT, 3 * UNIT), 0, 0, -4 * UNIT);
  CHECK(corner(p, a, b, c, 0));
  check_time(3 * CCD_ONE / 4);
  check_near(contact.weight[0], CCD_ONE / 4, 4);
  check_near(contact.weight[1], CCD_ONE / 2, 4);
  check_normal(0, 0, -(1 << 30));
  CHECK(corner(p, a, b, c, UNIT));
  check_time(CCD_ONE / 2);
  const ccd_path beside = moving(still(2 * UNIT + 2000, 2 * UNIT, 3 * UNIT), 0, 0, -4 * UNIT);
  CHECK(!corner(beside, a, b, c, 0));
  CHECK(corner(beside, a, b, c, 2000));
}
/* From corner to corner of the world. */
static void the_whole_world_fits(void) {
  const ccd_path a = {{-FAR, -FAR, -FAR}, {FAR, FAR, FAR}};
  const ccd_path b = {{FAR, FAR, -FAR}, {-FAR, -FAR, FAR}};
  const ccd_path c = {{-FAR, FAR, FAR}, {FAR, -FAR, -FAR}};
  const ccd_path d = {{FAR, -FAR, FAR}, {-FAR, FAR, -FAR}};
  CHECK(edges(a, b, c, d, 0));
  check_time(CCD_ONE / 2);
  CHECK(corner(a, b, c, d, FAR));
  CHECK(!edges(still(-FAR, -FAR, -FAR), still(-FAR, FAR, -FAR), still(FAR, FAR, FAR),
               still(FAR, -FAR, FAR), FAR));
}

static uint64_t mix(uint64_t digest, int32_t word) {
  const uint64_t v = (digest ^ (uint32_t)word) * 0x9E3779B97F4A7C15u;
  return v ^ v >> 29;
}
/* The same on every machine and compiler; it changes when what is computed changes. */
static void results_are_the_same_everywhere(void) {
  uint64_t digest = 1;
  for (uint32_t n = 0; n < FAMILIES * 2 * 3000; ++n) {
    const int triangle = n / 3000 % 2 != 0;
    ccd_path p[4];
    families[n / 6000].make(p, triangle);
    if (!ccd_of_pair(p, triangle, n % 3 == 0 ? FX_LU / 50 : 0, &contact)) continue;
    const int32_t words[] = {(int32_t)n,       contact.time,     contact.weight[0],   contact.weight[1],
                             contact.normal.x, contact.normal.y, contact.normal.z};
    for (uint32_t k = 0; k < 7; ++k) digest = mix(digest, words[k]);
  }
  CHECK_EQ_INT(digest, -670801407287580536);
}

int main(void) {
  TEST(edges_cross);
  TEST(edges_pass);
  TEST(the_last_moment_counts);
  TEST(corners_are_round);
  TEST(what_is_degenerate_touches);
  TEST(a_point_meets_a_triangle);
  TEST(the_whole_world_fits);
  TEST(results_are_the_same_everywhere);
  return test_end();
}
