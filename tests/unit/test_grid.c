/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of boxes that overlap, against all pairs tried one by one. */
#include <stdlib.h>

#include "rt/base/grid.h"
#include "rt/base/random.h"
#include "tests/lib/test.h"

enum { MOST = 300, PAIRS = MOST * MOST / 2, BUCKETS = 1024, GUARD = 0x5A };

typedef struct {
  grid_box boxes[MOST];
  grid_id corners[3 * MOST];
  uint8_t flags[MOST + 1];
  grid_list list;
} elements;

static elements one, other;
static grid g;
static grid_id bucket[BUCKETS + 2];
static grid_id entry[MOST + 1], wide[MOST + 1];
static grid_pair found[PAIRS + 1];
static uint32_t seed;

static int32_t pick(int32_t low, int32_t high) { return random_between(1, ++seed, low, high); }

static vec3 pick_vector(int32_t most) {
  vec3 v;
  v.x = pick(-most, most);
  v.y = pick(-most, most);
  v.z = pick(-most, most);
  return v;
}

static void set_grid(uint32_t buckets, uint32_t cell_bits) {
  g.bucket = bucket;
  g.entry = entry;
  g.buckets = buckets;
  g.wide = wide;
  g.wide_most = MOST;
  g.cell_bits = cell_bits;
  g.cells_most = 512;
  g.visits_most = 64 * MOST;
  g.partners_most = GRID_PARTNERS;
}
static void set_list(elements *e, uint32_t count, uint32_t corners_each) {
  e->list.boxes = e->boxes;
  e->list.corners = e->corners;
  e->list.corners_each = corners_each;
  e->list.flags = e->flags;
  e->list.count = count;
  e->flags[count] = GUARD;
  for (uint32_t n = 0; n < count * corners_each; ++n) e->corners[n] = (grid_id)pick(0, 400);
}
/* Boxes to `width` within `spread` of a centre, which may be at the world's edge. */
static void set_boxes(elements *e, uint32_t count, int32_t centre, int32_t spread, int32_t width) {
  for (uint32_t n = 0; n < count; ++n)
    for (uint32_t k = 0; k < 3; ++k) {
      const int32_t low = fx_clamp(centre + pick(-spread, spread), INT16_MIN, INT16_MAX);
      e->boxes[n].low[k] = (int16_t)low;
      e->boxes[n].high[k] = (int16_t)fx_min(low + pick(0, width), INT16_MAX);
    }
}

static int is_pair(const elements *a, uint32_t n, const elements *b, uint32_t m) {
  for (uint32_t k = 0; k < 3; ++k)
    if (a->boxes[n].low[k] > b->boxes[m].high[k] || b->boxes[m].low[k] > a->boxes[n].high[k])
      return 0;
  for (uint32_t i = 0; i < a->list.corners_each; ++i)
    for (uint32_t j = 0; j < b->list.corners_each; ++j)
      if (a->corners[n * a->list.corners_each + i] == b->corners[m * b->list.corners_each + j])
        return 0;
  return 1;
}

/* Holds `count` found pairs against all; returns how many were left out, each with a flag. */
static uint32_t left_out(const elements *a, const elements *b, uint32_t count) {
  uint32_t at = 0;
  uint32_t left = 0;
  uint32_t bad = 0;
  for (uint32_t n = 0; n < a->list.count; ++n)
    for (uint32_t m = a == b ? n + 1u : 0; m < b->list.count; ++m) {
      if (!is_pair(a, n, b, m)) continue;
      if (at < count && found[at].a == n && found[at].b == m) {
        ++at;
        continue;
      }
      ++left;
      bad += a->flags[n] == 0 && b->flags[m] == 0;
    }
  CHECK_EQ_INT(bad, 0);
  CHECK_EQ_INT(at, count); /* all of them are pairs, sorted, once each */
  CHECK_EQ_INT(a->flags[a->list.count], GUARD);
  CHECK_EQ_INT(b->flags[b->list.count], GUARD);
  return left;
}

static void all_pairs_are_found(void) {
  uint32_t total = 0;
  for (uint32_t trial = 0; trial < 400; ++trial) {
    const uint32_t count = (uint32_t)pick(0, MOST);
    const int32_t width = pick(0, 60);
    const int32_t spread = pick(150, 800);
    const int32_t centre = pick(0, 3) == 0 ? INT16_MAX - spread : pick(-20000, 20000);
    set_grid(2u << pick(0, 9), 6);
    set_list(&one, count, (uint32_t)pick(0, 3));
    set_boxes(&one, count, centre, spread, width);
    grid_fill(&g, &one.list);
    const uint32_t pairs = grid_find(&g, &one.list, &one.list, found, PAIRS);
    total += pairs;
    CHECK_EQ_INT(left_out(&one, &one, pairs), 0);
  }
  printf("figure grid_pairs %u (none left out)\n", total);
  CHECK(total > 1000);
}

static void two_lists_meet(void) {
  for (uint32_t trial = 0; trial < 200; ++trial) {
    set_grid(256, 6);
    set_list(&one, (uint32_t)pick(0, MOST), 3);
    set_list(&other, (uint32_t)pick(0, MOST), 1);
    set_boxes(&one, one.list.count, 0, pick(300, 3000), 60);
    set_boxes(&other, other.list.count, 0, 3000, 20);
    grid_fill(&g, &one.list);
    const uint32_t pairs = grid_find(&g, &one.list, &other.list, found, PAIRS);
    CHECK_EQ_INT(left_out(&other, &one, pairs), 0);
  }
}

/* Everything too small, one at a time and together; nothing is written past what there is. */
static void what_is_left_out_is_flagged(void) {
  uint32_t left = 0;
  uint32_t flagged = 0;
  for (uint32_t trial = 0; trial < 600; ++trial) {
    const uint32_t count = (uint32_t)pick(1, MOST);
    const uint32_t capacity = trial % 2u != 0 ? (uint32_t)pick(0, 300) : PAIRS;
    const uint32_t buckets = 16u << pick(0, 6);
    set_grid(buckets, (uint32_t)pick(3, 8));
    if (trial % 3u == 0) g.wide_most = (uint32_t)pick(0, 60);
    if (trial % 5u == 0) g.visits_most = (uint32_t)pick(0, 100);
    if (trial % 7u == 0) g.partners_most = (uint32_t)pick(0, 8);
    if (trial % 4u == 0) g.cells_most = (uint32_t)pick(0, 60);
    set_list(&one, count, 2);
    const int32_t width = pick(0, 200);
    set_boxes(&one, count, 0, pick(10, 2000), width);
    entry[count] = 0x5A5A;
    wide[g.wide_most] = 0x5A5A;
    bucket[g.buckets + 1u] = GUARD;
    found[capacity].a = 0x5A5A;
    grid_fill(&g, &one.list);
    const uint32_t pairs = grid_find(&g, &one.list, &one.list, found, capacity);
    left += left_out(&one, &one, pairs);
    for (uint32_t n = 0; n < count; ++n) flagged += one.flags[n] != 0;
    CHECK(pairs <= capacity);
    CHECK_EQ_INT(entry[count], 0x5A5A);
    CHECK_EQ_INT(wide[g.wide_most], 0x5A5A);
    CHECK_EQ_INT(bucket[g.buckets + 1u], GUARD);
    CHECK_EQ_INT(found[capacity].a, 0x5A5A);
  }
  printf("figure grid_left_out %u pairs, of %u flagged boxes\n", left, flagged);
  CHECK(left > 1000);
}

static void flags_name_their_reason(void) {
  set_grid(16, 6);
  set_list(&one, 4, 0);
  for (uint32_t n = 0; n < 4; ++n)
    for (uint32_t k = 0; k < 3; ++k) {
      one.boxes[n].low[k] = 0;
      one.boxes[n].high[k] = n == 0 ? 1000 : 10;
    }
  g.wide_most = 0;
  grid_fill(&g, &one.list);
  CHECK_EQ_INT(one.flags[0], GRID_LARGE);
  CHECK_EQ_INT(grid_find(&g, &one.list, &one.list, found, 1), 1);
  CHECK_EQ_INT(found[0].a, 1);
  CHECK_EQ_INT(found[0].b, 2);
  CHECK_EQ_INT(one.flags[1], GRID_PAIRS);
  CHECK_EQ_INT(one.flags[2], GRID_PAIRS);
  CHECK_EQ_INT(one.flags[3], 0);
  g.wide_most = 1;
  grid_fill(&g, &one.list);
  CHECK_EQ_INT(one.flags[0], 0);
  CHECK_EQ_INT(grid_find(&g, &one.list, &one.list, found, 9), 3); /* 17^3 cells to look into */
  CHECK_EQ_INT(one.flags[0], GRID_LARGE);
  g.cells_most = 17 * 17 * 17;
  g.visits_most = 0;
  grid_fill(&g, &one.list);
  CHECK_EQ_INT(grid_find(&g, &one.list, &one.list, found, 9), 0);
  CHECK_EQ_INT(one.flags[0], GRID_CROWDED);
  g.visits_most = 4 * 17 * 17 * 17;
  grid_fill(&g, &one.list);
  CHECK_EQ_INT(grid_find(&g, &one.list, &one.list, found, 9), 6);
  CHECK_EQ_INT(one.flags[0], 0);
}

/* The number of buckets changes what is visited, not what is found. */
static void pairs_do_not_depend_on_the_table(void) {
  static grid_pair before[PAIRS];
  uint32_t count = 0;
  set_list(&one, MOST, 2);
  set_boxes(&one, MOST, 0, 200, 60);
  for (uint32_t buckets = 2; buckets <= BUCKETS; buckets *= 2u) {
    set_grid(buckets, 6);
    grid_fill(&g, &one.list);
    const uint32_t pairs = grid_find(&g, &one.list, &one.list, found, PAIRS);
    if (buckets > 2) CHECK_EQ_INT(pairs, count);
    if (buckets > 2) CHECK(memcmp(before, found, pairs * sizeof found[0]) == 0);
    count = pairs;
    memcpy(before, found, pairs * sizeof found[0]);
  }
  CHECK(count > 50);
}

/* Points that come within the thickness of each other have boxes that touch, whatever the drift. */
static void boxes_hold_their_ways(void) {
  uint32_t near = 0;
  for (uint32_t trial = 0; trial < 300000; ++trial) {
    sweep_point p[2];
    const int32_t most = (int32_t)1 << pick(1, 29);
    const int32_t thickness = pick(0, most);
    const vec3 drift = pick_vector(most);
    for (uint32_t n = 0; n < 2; ++n) {
      p[n].begin = pick_vector(most);
      p[n].end = pick_vector(most);
    }
    const grid_box a = grid_box_of(&p[0], 1, thickness, drift);
    const grid_box b = grid_box_of(&p[1], 1, thickness, drift);
    const vec3 d = vec_sub(p[1].begin, p[0].begin);
    const vec3 e = vec_sub(p[1].end, p[0].end);
    const uint32_t h = (uint32_t)thickness;
    if ((fx_magnitude(d.x) > h || fx_magnitude(d.y) > h || fx_magnitude(d.z) > h) &&
        (fx_magnitude(e.x) > h || fx_magnitude(e.y) > h || fx_magnitude(e.z) > h))
      continue;
    ++near;
    for (uint32_t k = 0; k < 3; ++k) CHECK(a.low[k] <= b.high[k] && b.low[k] <= a.high[k]);
  }
  CHECK(near > 10000);
}
static void boxes_by_hand(void) {
  const sweep_point p[2] = {{{0, -FX_LU, FX_LU / 2}, {FX_LU, -FX_LU, FX_LU / 2}},
                            {{FX_WORLD_MAX, 3, 0}, {FX_WORLD_MAX, 0, 0}}};
  const grid_box a = grid_box_of(p, 1, 0, vec_make(0, 0, 0));
  CHECK_EQ_INT(a.low[0], 0);
  CHECK_EQ_INT(a.high[0], 512);
  CHECK_EQ_INT(a.low[1], -512);
  CHECK_EQ_INT(a.high[1], -512);
  CHECK_EQ_INT(a.low[2], 256);
  CHECK_EQ_INT(a.high[2], 256);
  const grid_box b = grid_box_of(p, 2, FX_LU, vec_make(FX_LU, 0, 0));
  CHECK_EQ_INT(b.low[0], -256);
  CHECK_EQ_INT(b.high[0], 60 * 512 + 256);
  const grid_box far = grid_box_of(p, 2, 0, vec_make(-FX_WORLD_MAX, 0, 0));
  CHECK_EQ_INT(far.high[0], INT16_MAX);
}

int main(void) {
  TEST(all_pairs_are_found);
  TEST(two_lists_meet);
  TEST(what_is_left_out_is_flagged);
  TEST(flags_name_their_reason);
  TEST(pairs_do_not_depend_on_the_table);
  TEST(boxes_hold_their_ways);
  TEST(boxes_by_hand);
  return test_end();
}
