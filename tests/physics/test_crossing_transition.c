/* SPDX-License-Identifier: Apache-2.0 */
/* Which crossings a strained spring and a couple that comes apart want split, against maps drawn by
 * hand (Metaaphanon 2009, section 3.4, figure 4). In the maps `#` came apart, `+` is to be split, `:` is
 * cut here, `=` is held. */
#include "tests/lib/test.h"

#include "rt/woven/woven.h"
#include "tests/lib/yarn_check.h"

enum { WARPS = 9, WEFTS = 7 };

static void open_sheet_of(fixture *f, const char *pattern, const char *spread) {
  fixture_print(f,
                "scene spread\nrate 1000 Hz\nsubsteps 4\nseed 5\nwoven {\n warps %d\n wefts %d\n"
                " spacing 12 /cm\n weave %s\n yarns on\n spread_splits %s\n}\npin row top\n",
                WARPS, WEFTS, pattern, spread);
}

static void open_sheet(fixture *f, const char *pattern) { open_sheet_of(f, pattern, "on"); }

static uint32_t crossing(uint32_t i, uint32_t j) { return j * WARPS + i; }

static void check_map(const fixture *f, const char *const map[WEFTS]) {
  for (uint32_t j = 0; j < WEFTS; ++j) {
    char row[WARPS + 1] = {0};
    for (uint32_t i = 0; i < WARPS; ++i) {
      const uint32_t c = crossing(i, j);
      row[i] = crossing_state_at(f->w, c) == FRAY_DISCONNECTED ? '#'
               : (f->w->woven.crossing_state[c] & CROSSING_PENDING) != 0 ? '+'
                                                        : '.';
    }
    CHECK_TEXT(row, map[j]);
  }
}

/* Splits a crossing and draws its warp away from the weft. */
static void come_apart(fixture *f, uint32_t c) {
  CHECK_EQ_INT(crossing_split(f->w, c, FRAY_LOOSE), 1);
  f->w->p.z[f->w->woven.warp_particle[c]] += FX_LU / 10;
  /* strained springs are another matter */
  params *p = fixture_params(f);
  p->tear_min = p->tear_max = 1 << 18;
  ((yarn_params *)(uintptr_t)f->w->woven.yarn_constants)->split_min = 1 << 18;
  ((yarn_params *)(uintptr_t)f->w->woven.yarn_constants)->split_max = 1 << 18;
  crossing_transition_find(f->w);
}

static void alone(void) {
  static const char *const map[WEFTS] = {".........", ".........", ".........", "....#....",
                                         ".........", ".........", "........."};
  fixture_scoped f = {0};
  open_sheet_of(&f, "plain", "off");
  come_apart(&f, crossing(4, 3));
  check_map(&f, map);
}

static void plain(void) {
  static const char *const map[WEFTS] = {".........", ".........", "....+....", "...+#+...",
                                         "....+....", ".........", "........."};
  fixture_scoped f = {0};
  open_sheet(&f, "plain");
  come_apart(&f, crossing(4, 3));
  check_map(&f, map);
}

/* Over where (i + j) % 3 < 2: at (4, 3) row 3 is over at i = 3 4 6 7, under at 2 5 8. */
static void twill_2_1(void) {
  static const char *const over[WEFTS] = {".........", "....+....", "....+....", "..++#+...",
                                          "....+....", ".........", "........."};
  /* the next crossing to the right is one of the others: its neighbours are all over */
  static const char *const under[WEFTS] = {".........", ".........", ".....+...", "....+#+..",
                                           ".....+...", ".........", "........."};
  fixture_scoped f = {0};
  open_sheet(&f, "twill 2/1");
  come_apart(&f, crossing(4, 3));
  check_map(&f, over);
  fixture_close(&f);
  open_sheet(&f, "twill 2/1");
  come_apart(&f, crossing(5, 3));
  check_map(&f, under);
}

/* Over where (i + j) % 4 < 2: at (4, 3) under; row 3 is over at i = 1 2 5 6, column 4 at j = 0 1 4 5. */
static void twill_2_2(void) {
  static const char *const map[WEFTS] = {".........", "....+....", "....+....", "..++#+...",
                                         "....+....", ".........", "........."};
  fixture_scoped f = {0};
  open_sheet(&f, "twill 2/2");
  come_apart(&f, crossing(4, 3));
  check_map(&f, map);
}

/* Under only at i = 2 j (mod 5): row 3 at 1 and 6, column 4 at 2. From (4, 3): to 1 and 6 along the weft;
 * along the warp up to 2, down to the edge. */
static void satin(void) {
  static const char *const map[WEFTS] = {".........", ".........", "....+....", ".+++#++..",
                                         "....+....", "....+....", "....+...."};
  fixture_scoped f = {0};
  open_sheet(&f, "satin 5");
  come_apart(&f, crossing(4, 3));
  check_map(&f, map);
}

/* Always over: along the yarns to their ends; the held row at the top stays whole. */
static void never_opposite(void) {
  static const char *const map[WEFTS] = {".........", "....+....", "....+....", "++++#++++",
                                         "....+....", "....+....", "....+...."};
  fixture_scoped f = {0};
  open_sheet(&f, "matrix {\n 1\n }");
  come_apart(&f, crossing(4, 3));
  check_map(&f, map);
}

static void a_cut_ends_the_spread(void) {
  static const char *const map[WEFTS] = {".........", "....+....", "....+....", "...+#++++",
                                         "....+....", "....+....", "....+...."};
  fixture_scoped f = {0};
  open_sheet(&f, "matrix {\n 1\n }");
  uint32_t next;
  uint32_t link;
  CHECK(yarn_grid_step(world_yarn_grid(f.w), crossing(3, 3), 0, &next, &link));
  world_kill_spring(f.w, f.w->woven.spring_of[link]);
  come_apart(&f, crossing(4, 3));
  check_map(&f, map);
}

/* One spring over its strain, along a weft and along a warp: both ends and their neighbours. */
static void a_strained_spring(void) {
  static const char *const weft[WEFTS] = {".........", ".........", "...++....", "..++++...",
                                          "...++....", ".........", "........."};
  static const char *const warp[WEFTS] = {".........", ".........", "....+....", "...+++...",
                                          "...+++...", "....+....", "........."};
  static const char *const top[WEFTS] = {".........", "...+++...", "....+....", ".........",
                                         ".........", ".........", "........."};
  const uint32_t from[3] = {crossing(3, 3), crossing(4, 3), crossing(4, 0)};
  const uint32_t to[3] = {crossing(4, 3), crossing(4, 4), crossing(4, 1)};
  const char *const *const maps[3] = {weft, warp, top};
  for (uint32_t n = 0; n < 3; ++n) {
    fixture_scoped f = {0};
    open_sheet(&f, "plain");
    /* all others as short as nothing, so that this one alone is long */
    for (uint32_t p = 0; p < f.w->p.count; ++p) f.w->p.x[p] = f.w->p.y[p] = f.w->p.z[p] = 0;
    for (uint32_t row = 0; row < (uint32_t)f.w->params->links; ++row) {
      uint32_t a, b;
      yarn_grid_ends(world_yarn_grid(f.w), f.w->woven.canonical_id[row], &a, &b);
      if (a != from[n] || b != to[n]) continue;
      const int32_t limit = world_split_strain(f.w, row);
      const int32_t rest = f.w->woven.link_classes[f.w->woven.spring_kind[row]].rest;
      CHECK(limit < world_tear_strain(f.w, row));
      const int32_t length = (int32_t)((int64_t)rest * (65536 + limit) >> 16);
      f.w->p.x[fray_crossing_particle(f.w, b)] = length - 2;
      /* its other springs are as long: kill them */
      for (uint32_t other = 0; other < (uint32_t)f.w->params->links; ++other)
        if (other != row) f.w->woven.spring_kind[other] = SPRING_DEAD;
      crossing_transition_find(f.w);
      CHECK_EQ_INT(f.w->woven.yarn_counts->pending, 0);
      f.w->p.x[fray_crossing_particle(f.w, b)] = length + 2;
      crossing_transition_find(f.w);
      break;
    }
    check_map(&f, maps[n]);
  }
}

int main(void) {
  TEST(alone);
  TEST(plain);
  TEST(twill_2_1);
  TEST(twill_2_2);
  TEST(satin);
  TEST(never_opposite);
  TEST(a_cut_ends_the_spread);
  TEST(a_strained_spring);
  return test_end();
}
