/* SPDX-License-Identifier: Apache-2.0 */
/* The measure of fray, counted by hand on a sheet that was cut by hand. */
#include "tests/lib/test.h"

#include "rt/state/crossing.h"
#include "tests/lib/world_fixture.h"
#include "tools/analysis/fraying.h"
#include "tools/analysis/components.h"

static void open_sheet(fixture *f, const char *yarns) {
  fixture_print(f, "scene ends\nrate 1000 Hz\nsubsteps 2\nwoven {\n warps 8\n wefts 6\n"
                   " spacing 10 5 /cm\n yarns %s\n}\npin row top\n", yarns);
}

static uint32_t crossing(uint32_t i, uint32_t j) { return j * 8 + i; }

/* The spring from (i, j) on, along its weft or its warp. */
static void cut_spring(fixture *f, uint32_t i, uint32_t j, uint32_t way) {
  uint32_t next;
  uint32_t link;
  CHECK(yarn_grid_step(world_yarn_grid(f->w), crossing(i, j), way, &next, &link));
  world_kill_spring(f->w, f->w->woven.spring_of[link]);
}

static void come_apart(fixture *f, uint32_t i, uint32_t j) {
  CHECK(crossing_split(f->w, crossing(i, j), FRAY_LOOSE));
  crossing_set_state(f->w, crossing(i, j), FRAY_DISCONNECTED);
}

static int near(double a, double b) { return fabs(a - b) < 1e-4; }

/* Weft 3 is cut between warps 3 and 4; warps 0.1 cm, wefts 0.2 cm apart. */
static void one_cut(void) {
  fixture_scoped f = {0};
  fraying e;
  open_sheet(&f, "on");
  cut_spring(&f, 3, 3, 1);
  CHECK(fraying_measure(f.w, &e));
  CHECK_EQ_INT(e.cuts, 1);
  CHECK_EQ_INT(e.ends, 0);
  CHECK(near(e.tear_cm, 0.2) && e.fray == 0);
  come_apart(&f, 3, 3);
  come_apart(&f, 2, 3);
  come_apart(&f, 0, 3); /* beyond a crossing that holds */
  come_apart(&f, 4, 3);
  CHECK(crossing_split(f.w, crossing(5, 3), FRAY_LOOSE)); /* slides, but holds */
  CHECK(fraying_measure(f.w, &e));
  CHECK_EQ_INT(e.ends, 2);
  CHECK(near(e.loose_cm, 0.3));
  CHECK(near(e.fray, 1.5));
  CHECK(near(e.zone_cm, 0.5)); /* 5 crossings of 0.1 x 0.2 on 0.2 */
  CHECK_EQ_INT(e.split, 5);
  CHECK_EQ_INT(e.loose, 1);
  CHECK_EQ_INT(e.disconnected, 4);
}

/* A piece of warp 5 between two cuts, loose all along: counted once. */
static void a_loose_thread_counts_once(void) {
  fixture_scoped f = {0};
  fraying e;
  open_sheet(&f, "on");
  cut_spring(&f, 5, 1, 3);
  cut_spring(&f, 5, 4, 3);
  for (uint32_t j = 2; j <= 4; ++j) come_apart(&f, 5, j);
  CHECK(fraying_measure(f.w, &e));
  CHECK_EQ_INT(e.cuts, 2);
  CHECK_EQ_INT(e.ends, 1);
  CHECK(near(e.tear_cm, 0.2) && near(e.loose_cm, 0.6) && near(e.fray, 3));
  component components[4];
  CHECK_EQ_INT(components_find(f.w, components, 4), 2);
  CHECK_EQ_INT(components[0].crossings, 48);
  CHECK_EQ_INT(components[1].crossings, 3);
  CHECK_EQ_INT(components[1].holders, 0);
}

static void without_yarns_it_is_zero(void) {
  fixture_scoped f = {0};
  fraying e;
  open_sheet(&f, "off");
  cut_spring(&f, 3, 3, 1);
  CHECK(fraying_measure(f.w, &e));
  CHECK_EQ_INT(e.cuts, 1);
  CHECK(e.fray == 0 && e.split == 0 && e.ends == 0);
}

int main(void) {
  TEST(one_cut);
  TEST(a_loose_thread_counts_once);
  TEST(without_yarns_it_is_zero);
  return test_end();
}
