/* SPDX-License-Identifier: Apache-2.0 */
/* What continuous collisions cost on a small target: one line for each piece between two marks.
 *
 *   FAMILY SHAPE none|contact     a call, pairs of tests/oracle; thickness 0, and 1/50 lu where
 *                                 the name ends in _thick
 *   POSE EDGES boxes|fill|find PAIRS FLAGGED     the grid, for a sheet's edges at 12 yarns/lu */
#include "rt/base/grid.h"
#include "tests/cross/cases.h"
#include "tests/cross/line.h"
#include "tests/oracle/pairs.h"

enum { CALLS = 300 };

void work_mark(void);
__attribute__((noinline)) void work_mark(void) { __asm__ volatile("" ::: "memory"); }

static void count_family(const family_row *row, int triangle, int32_t thickness) {
  line l = {{0}, 0};
  for (uint32_t n = 0; n < CALLS; ++n) {
    sweep_point p[4];
    sweep_contact c;
    row->make(p, triangle);
    work_mark();
    const int found = sweep_pair(p, triangle, thickness, &c);
    work_mark();
    add_text(&l, row->name);
    add_text(&l, thickness != 0 ? "_thick" : "");
    add_text(&l, triangle ? " triangle" : " edges");
    add_text(&l, found ? " contact" : " none");
    print_line(&l);
  }
}

enum { SIDE = 16, EDGES = 2 * SIDE * (SIDE - 1), PAIRS = 4 * EDGES, SPACING = FX_LU / 12 };
typedef enum { FLAT, ASKEW, FOLDED, CRUMPLED, HEAP, POSES } pose;
static const char *const poses[POSES] = {"flat", "askew", "folded", "crumpled", "heap"};

static sweep_point at[SIDE * SIDE];
static grid_box boxes[EDGES];
static grid_id corners[2 * EDGES];
static uint8_t flags[EDGES];
static grid_id bucket[1024 + 1];
static grid_id entry[EDGES];
static grid_id wide[16];
static grid_pair pairs[PAIRS];

/* Back and forth over two spacings. */
static int32_t zigzag(int32_t n) { return (n % 4 < 3 ? n % 4 : 1) * SPACING; }

static void lay(pose how) {
  for (int32_t n = 0; n < SIDE * SIDE; ++n) {
    const int32_t fold = how == FOLDED && n / SIDE >= SIDE / 2;
    const int32_t i = (n % SIDE) * SPACING;
    const int32_t j = (fold ? SIDE - 1 - n / SIDE : n / SIDE) * SPACING;
    vec3 p = vec_make(i, j, fold ? FX_LU / 40 : 0);
    if (how == ASKEW || how == CRUMPLED)
      p = vec_make(i / 5 * 3 - j / 5 * 4, i / 25 * 16 + j / 25 * 12, i / 25 * 12 + j / 25 * 9);
    if (how == HEAP) p = vec_make(zigzag(n % SIDE), zigzag(n / SIDE), 0);
    if (how == CRUMPLED || how == HEAP) p = vec_add(p, anywhere(SPACING / 4));
    at[n].begin = p;
    at[n].end = vec_add(p, anywhere(FX_LU / 400));
  }
}
static void add_edge(uint32_t e, uint32_t a, uint32_t b) {
  const sweep_point ends[2] = {at[a], at[b]};
  corners[2u * e] = (grid_id)a;
  corners[2u * e + 1u] = (grid_id)b;
  boxes[e] = grid_box_of(ends, 2, FX_LU / 50, vec_make(0, 0, 0));
}
static void make_boxes(void) {
  uint32_t e = 0;
  for (uint32_t n = 0; n < SIDE * SIDE; ++n) {
    if (n % SIDE + 1u < SIDE) add_edge(e++, n, n + 1u);
    if (n / SIDE + 1u < SIDE) add_edge(e++, n, n + SIDE);
  }
}
static void say(pose how, const char *what, uint32_t found) {
  line l = {{0}, 0};
  uint32_t flagged = 0;
  for (uint32_t n = 0; n < EDGES; ++n) flagged += flags[n] != 0;
  add_text(&l, poses[how]);
  add_text(&l, " ");
  add_number(&l, EDGES);
  add_text(&l, what);
  add_number(&l, found);
  add_text(&l, " ");
  add_number(&l, flagged);
  print_line(&l);
}
static void count_grid(pose how) {
  const grid_list list = {boxes, corners, flags, EDGES, 2};
  grid g = {bucket, entry, wide, 1024, 16, 6, 64, 160, GRID_PARTNERS, 0, {0, 0, 0}};
  lay(how);
  work_mark();
  make_boxes();
  work_mark();
  say(how, " boxes ", 0);
  work_mark();
  grid_fill(&g, &list);
  work_mark();
  say(how, " fill ", 0);
  work_mark();
  const uint32_t found = grid_find(&g, &list, &list, pairs, PAIRS);
  work_mark();
  say(how, " find ", found);
}

int main(void) {
  for (uint32_t n = 0; n < POSES; ++n) count_grid((pose)n);
  for (uint32_t n = 0; n < FAMILIES; ++n)
    for (int triangle = 0; triangle < 2; ++triangle) {
      count_family(&families[n], triangle, 0);
      if (n >= 1 && n <= 2) count_family(&families[n], triangle, FX_LU / 50);
    }
  port_print("end\n");
  return 0;
}
