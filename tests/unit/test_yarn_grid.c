/* SPDX-License-Identifier: Apache-2.0 */
/* Canonical numbers of springs, and what a cut releases. */
#include "rt/state/yarn_grid.h"
#include "tests/lib/splitmix64.h"
#include "tests/lib/test.h"

enum { SIDE_MAX = 9, CROSSINGS = SIDE_MAX * SIDE_MAX, ROWS = 6 * CROSSINGS };

/* 4 warps, 3 wefts: crossings 0 1 2 3 / 4 5 6 7 / 8 9 10 11; links 0..8 along wefts, 9..16 along
 * warps; bends 17..22 along wefts, 23..26 along warps; shears 27..38, two a cell. */
static const yarn_grid grid = {4, 3};

static void numbers_on_a_grid_of_4_by_3(void) {
  static const uint32_t ends[][3] = {
      /* links */ {0, 0, 1},  {2, 2, 3},   {3, 4, 5},    {8, 10, 11}, {9, 0, 4},
      {12, 3, 7},            {13, 4, 8},  {16, 7, 11},
      /* bends */ {17, 0, 2}, {18, 1, 3},  {19, 4, 6},   {22, 9, 11}, {23, 0, 8},
      {26, 3, 11},
      /* shears */ {27, 0, 5}, {28, 1, 4}, {31, 2, 7},   {32, 3, 6},  {33, 4, 9},
      {34, 5, 8},            {37, 6, 11}, {38, 7, 10}};
  CHECK_EQ_INT(yarn_grid_links(grid), 17);
  CHECK_EQ_INT(yarn_grid_bends(grid), 10);
  CHECK_EQ_INT(yarn_grid_shears(grid), 12);
  for (uint32_t n = 0; n < sizeof ends / sizeof ends[0]; ++n) {
    uint32_t a;
    uint32_t b;
    yarn_grid_ends(grid, ends[n][0], &a, &b);
    CHECK_EQ_INT(a, ends[n][1]);
    CHECK_EQ_INT(b, ends[n][2]);
  }
}

static void check_released(uint32_t link, uint32_t count, const uint32_t *expected) {
  uint32_t released[YARN_GRID_RELEASED];
  CHECK_EQ_INT(yarn_grid_released(grid, link, released), count);
  for (uint32_t n = 0; n < count; ++n) {
    uint32_t found = 0;
    for (uint32_t k = 0; k < count; ++k) found += released[k] == expected[n];
    CHECK_EQ_INT(found, 1);
  }
}

static void releases_on_a_grid_of_4_by_3(void) {
  check_released(0, 3, (const uint32_t[]){17, 27, 28});              /* a corner, along the edge */
  check_released(1, 4, (const uint32_t[]){17, 18, 29, 30});          /* the middle of an edge */
  check_released(4, 6, (const uint32_t[]){19, 20, 35, 36, 29, 30});  /* inside, along a weft */
  check_released(8, 3, (const uint32_t[]){22, 37, 38});              /* the last corner */
  check_released(9, 3, (const uint32_t[]){23, 27, 28});              /* a corner, along a warp */
  check_released(14, 5, (const uint32_t[]){24, 35, 36, 33, 34});     /* inside, along a warp */
  check_released(16, 3, (const uint32_t[]){26, 37, 38});
}

static void mirrors_on_a_grid_of_4_by_3(void) {
  CHECK_EQ_INT(yarn_grid_mirror(grid, 0), 0);
  CHECK_EQ_INT(yarn_grid_mirror(grid, 2), 0);
  CHECK_EQ_INT(yarn_grid_mirror(grid, 1), 1); /* its own mirror image */
  CHECK_EQ_INT(yarn_grid_mirror(grid, 8), 6);
  CHECK_EQ_INT(yarn_grid_mirror(grid, 12), 9);
  CHECK_EQ_INT(yarn_grid_mirror(grid, 11), 10);
}

/* Every grid from 2 x 2: numbers come back as they went in, by the formulas of rt/fray.h, and no
 * two springs have the same ends. */
static void numbers_come_back(void) {
  for (uint32_t warps = 2; warps <= SIDE_MAX; ++warps)
    for (uint32_t wefts = 2; wefts <= SIDE_MAX; ++wefts) {
      const yarn_grid w = {warps, wefts};
      uint8_t seen[CROSSINGS][CROSSINGS];
      memset(seen, 0, sizeof seen);
      for (uint32_t n = 0; n < yarn_grid_links(w); ++n) {
        const yarn_grid_link l = yarn_grid_link_at(w, n);
        CHECK_EQ_INT(l.along_warp ? wefts * (warps - 1) + l.j * warps + l.i
                                  : l.j * (warps - 1) + l.i,
                     n);
        CHECK(l.i + (l.along_warp == 0) < warps && l.j + l.along_warp < wefts);
        const uint32_t m = yarn_grid_mirror(w, n);
        CHECK(m <= n && yarn_grid_mirror(w, m) == m);
      }
      for (uint32_t n = 0; n < yarn_grid_links(w) + yarn_grid_bends(w) + yarn_grid_shears(w); ++n) {
        uint32_t a;
        uint32_t b;
        yarn_grid_ends(w, n, &a, &b);
        CHECK(a < warps * wefts && b < warps * wefts && a != b);
        const int di = (int)(b % warps) - (int)(a % warps);
        const int dj = (int)(b / warps) - (int)(a / warps);
        if (n < yarn_grid_links(w))
          CHECK_EQ_INT(di * 10 + dj, n < wefts * (warps - 1) ? 10 : 1);
        else if (n < yarn_grid_links(w) + yarn_grid_bends(w))
          CHECK(di * 10 + dj == 20 || di * 10 + dj == 2);
        else
          CHECK(dj == 1 && (di == 1 || di == -1));
        CHECK_EQ_INT(seen[a][b] + seen[b][a], 0);
        seen[a][b] = 1;
      }
    }
}

static uint32_t root_of(uint32_t *parent, uint32_t n) {
  while (parent[n] != n) n = parent[n] = parent[parent[n]];
  return n;
}

/* Random cuts on random grids: every spring that is left ties two crossings that links still
 * connect. And no more is released than has to be by weave.h's rule: a bend spring lives as long as
 * both links under it, a diagonal as long as its cell's four. */
static void pieces_that_share_no_link_share_no_spring(void) {
  uint64_t seed = 15;
  uint32_t apart = 0;
  uint32_t pieces_seen = 0;
  for (uint32_t trial = 0; trial < 1000; ++trial) {
    const yarn_grid w = {2 + (uint32_t)(splitmix64(&seed) % 8), 2 + (uint32_t)(splitmix64(&seed) % 8)};
    const uint64_t share = splitmix64(&seed) % 100;
    const uint32_t links = yarn_grid_links(w);
    const uint32_t rows = links + yarn_grid_bends(w) + yarn_grid_shears(w);
    uint8_t dead[ROWS] = {0};
    uint8_t joined[CROSSINGS][CROSSINGS]; /* by a live link */
    uint32_t parent[CROSSINGS];
    memset(joined, 0, sizeof joined);
    for (uint32_t c = 0; c < CROSSINGS; ++c) parent[c] = c;
    for (uint32_t link = 0; link < links; ++link) {
      if (splitmix64(&seed) % 100 >= share) continue;
      uint32_t released[YARN_GRID_RELEASED];
      const uint32_t count = yarn_grid_released(w, link, released);
      dead[link] = 1;
      for (uint32_t n = 0; n < count; ++n) {
        CHECK(released[n] >= links && released[n] < rows);
        dead[released[n]] = 1;
      }
    }
    for (uint32_t n = 0; n < rows; ++n) {
      uint32_t a;
      uint32_t b;
      yarn_grid_ends(w, n, &a, &b);
      if (n < links && !dead[n]) {
        parent[root_of(parent, a)] = root_of(parent, b);
        joined[a][b] = joined[b][a] = 1;
      }
      if (n < links) continue;
      /* links come first, so all of them are in by now */
      if (!dead[n]) apart += root_of(parent, a) != root_of(parent, b);
      const uint32_t low = a < b ? a : b;
      const uint32_t high = a < b ? b : a;
      int whole;
      if (n < links + yarn_grid_bends(w)) {
        whole = joined[a][(a + b) / 2] && joined[(a + b) / 2][b];
      } else {
        const uint32_t corner = low % w.warps < high % w.warps ? low : low - 1;
        whole = joined[corner][corner + 1] && joined[corner][corner + w.warps] &&
                joined[corner + 1][corner + 1 + w.warps] &&
                joined[corner + w.warps][corner + w.warps + 1];
      }
      CHECK_EQ_INT(!dead[n], whole);
    }
    for (uint32_t c = 0; c < w.warps * w.wefts; ++c) pieces_seen += root_of(parent, c) == c;
  }
  printf("figure weave_springs_between_pieces %u (asked: 0; 1000 trials, %u pieces)\n", apart,
         pieces_seen);
  CHECK_EQ_INT(apart, 0);
  CHECK(pieces_seen > 2000);
}

int main(void) {
  TEST(numbers_on_a_grid_of_4_by_3);
  TEST(releases_on_a_grid_of_4_by_3);
  TEST(mirrors_on_a_grid_of_4_by_3);
  TEST(numbers_come_back);
  TEST(pieces_that_share_no_link_share_no_spring);
  return test_end();
}
