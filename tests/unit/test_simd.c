/* SPDX-License-Identifier: Apache-2.0 */
/* Every kernel that this machine has against the scalar code, to the last bit, on random batches of
 * random rows: ends together, worlds apart, at the edges of every clamp; every class that an image
 * may have. All arrays of the kernel lie against a page that faults, in a pattern that must stay.
 *
 *   test_simd [ROWS]     of each family, 10,000,000 unless told, a tenth under sanitizers */
#define _DEFAULT_SOURCE 1 /* mmap without a file */
#include <math.h>

#include "tests/lib/test.h"

#include "rt/woven/woven.h"
#include "tests/lib/guarded.h"
#include "tests/lib/simd_kernels.h"

enum {
  HELD_MOST = 6,
  BATCHES_MOST = 6,
  BATCH_ROWS_MOST = 150, /* more than two rounds of groups that kernels take side by side */
  ROWS_MOST = BATCHES_MOST * BATCH_ROWS_MOST,
  PARTICLES_MOST = HELD_MOST + 2 * BATCH_ROWS_MOST + 60,
  CLASSES_MOST = MAX_CLASSES,
  CASES_A_CLASS = 64,
  CUTS_MOST = 5
};
#define PLACE_MAX (62 * FX_LU)

enum { LINKS, SPRINGS, TEARS, LOCKS }; /* the stage that runs; what tears are links */

/* All that a stage reads and writes. */
typedef struct {
  uint32_t particles, held, rows, batch_count, classes, stage;
  int32_t x[3][PARTICLES_MOST], v[3][PARTICLES_MOST];
  index_t i[ROWS_MOST], j[ROWS_MOST];
  uint8_t kind[ROWS_MOST];
  spring_batch batches[BATCHES_MOST];
  link_class links[CLASSES_MOST];
  bend_shear_class springs[CLASSES_MOST];
  body_motion motion;
  int32_t tear_min, tear_max;
  uint32_t cut_count, over;
  torn_spring cuts[CUTS_MOST];
} sheet;

static uint64_t rows_asked = GUARDED_SLOW ? 1000000 : 10000000;


/* ---- classes: all that validate.c lets through ---- */

static void make_classes(sheet *s) {
  s->classes = draw_below(8) == 0 ? CLASSES_MOST : 2 + draw_below(CLASSES_MOST - 2);
  /* dead rows have class 0, which may hold anything */
  s->links[0] = (link_class){draw_between(1, INT32_MAX), draw_between(1, INT32_MAX), draw_between(1, INT32_MAX),
                             draw_between(1, INT32_MAX), draw_between(1, 4096)};
  memset(&s->springs[0], 0x1D, sizeof s->springs[0]);
  for (uint32_t n = 1; n < s->classes; ++n) {
    const int32_t least = LINK_UNITS_MIN << LINK_SHIFT;
    const int32_t most = LINK_UNITS_MAX << LINK_SHIFT;
    const int32_t rest = draw_below(4) == 0 ? draw_either(least, most) : draw_between(least, most);
    s->links[n] = link_class_make(rest, draw_below(3) == 0 ? draw_either(0, 4096) : draw_between(0, 4096));
    const int32_t length = 1 << draw_between(13, 22);
    const int32_t shorter = draw_between(length / 2, length);
    const int32_t mantissa = draw_below(8) == 0 ? 0 : draw_either((1 << 16) - 1, draw_between(1 << 15, (1 << 16) - 1));
    const int32_t shift = draw_below(4) == 0 ? draw_either(17, 46) : draw_between(17, 34);
    s->springs[n] = bend_shear_class_make(
        draw_below(3) == 0 || shorter < BEND_SHEAR_REST_MIN ? length : shorter, mantissa, shift, draw_either(0, 1));
  }
  if (s->stage != LOCKS) return;
  s->classes = CLASSES_WITH_LOCK;
  s->links[CLASS_LOCK] = s->links[CLASS_LOCK + 1] =
      link_class_of_lock(draw_between(LOCK_UNITS_MIN << LINK_SHIFT, LINK_UNITS_MAX << LINK_SHIFT));
}

/* ---- rows ---- */

static int all_free(const uint8_t *used, uint32_t first, uint32_t count) {
  for (uint32_t n = 0; n < count; ++n)
    if (used[first + n] != 0) return 0;
  return 1;
}
static uint32_t free_after(const uint8_t *used, uint32_t particles, uint32_t from) {
  while (used[from % particles] != 0) ++from;
  return from % particles;
}
/* Where a run may start: often at either end of the particles, which is next to the guard. */
static uint32_t run_start(const sheet *s, uint32_t length) {
  const uint32_t last = s->particles - length;
  switch (draw_below(6)) {
    case 0: return s->held;
    case 1: return last;
    default: return s->held + draw_below(last - s->held + 1);
  }
}

/* A run of rows whose ends follow one another, if there is room; one row always finds it. */
static uint32_t place_run(sheet *s, uint8_t *used, uint32_t row, uint32_t length, int held) {
  uint32_t i = 0;
  uint32_t j = 0;
  int found = 0;
  for (uint32_t attempt = 0; attempt < 6 && !found && !held; ++attempt) {
    i = run_start(s, length);
    j = run_start(s, length);
    found = (i + length <= j || j + length <= i) && all_free(used, i, length) && all_free(used, j, length);
  }
  if (!found) {
    length = 1;
    i = held ? draw_below(s->held) : free_after(used, s->particles, draw_below(s->particles));
    if (!held) used[i] = 1;
    j = free_after(used, s->particles, draw_below(s->particles));
  }
  for (uint32_t n = 0; n < length; ++n) {
    s->i[row + n] = (index_t)(i + n);
    s->j[row + n] = (index_t)(j + n);
    if (!held) used[i + n] = 1;
    used[j + n] = 1;
  }
  return length;
}

/* `light`: whether rows of the batch may have light ends. */
static uint8_t live_kind(const sheet *s, int light) {
  static const uint8_t ends[] = {0, SPRING_HALF_MASS | SPRING_HALF_I, SPRING_HALF_MASS | SPRING_HALF_J,
                                 SPRING_HALF_MASS | SPRING_HALF_I | SPRING_HALF_J};
  const uint32_t class = s->stage == LOCKS ? CLASS_SHEAR + draw_below(2) : 1 + draw_below(s->classes - 1);
  return (uint8_t)(class | (light ? ends[draw_below(4)] : 0u));
}

static void make_batch(sheet *s, const spring_batch *b) {
  uint8_t used[PARTICLES_MOST] = {0};
  const uint32_t end = (uint32_t)(b->first + b->count);
  const uint32_t runs = draw_below(4);
  const uint32_t dead = draw_below(4);
  const int light = draw_below(3) == 0;
  uint8_t kind = live_kind(s, light);
  for (uint32_t p = 0; p < s->held; ++p) used[p] = 1;
  for (uint32_t row = (uint32_t)b->first; row < end;) {
    uint32_t length = draw_below(4) < runs ? 1 + draw_below(draw_below(4) == 0 ? BATCH_ROWS_MOST : 40) : 1;
    if (length > end - row) length = end - row;
    row += place_run(s, used, row, length, b->attached == BATCH_ATTACHED);
  }
  const uint32_t same_class = draw_below(3); /* all, runs, none */
  for (uint32_t row = (uint32_t)b->first; row < end; ++row) {
    if (same_class == 2 || (same_class == 1 && draw_below(8) == 0)) kind = live_kind(s, light);
    s->kind[row] = (dead == 1 && draw_below(20) == 0) || (dead == 2 && draw_below(2) == 0) ||
                   (dead == 3 && draw_below(24) < 20 && same_class == 0) ? SPRING_DEAD : kind;
  }
}

static void make_batches(sheet *s) {
  uint32_t most = 0;
  s->batch_count = 1 + draw_below(BATCHES_MOST);
  s->rows = 0;
  s->held = 0;
  for (uint32_t n = 0; n < s->batch_count; ++n) {
    const uint32_t count = draw_below(3) == 0 ? 1 + draw_below(20) : 1 + draw_below(BATCH_ROWS_MOST);
    const int32_t held = draw_below(10) == 0 ? BATCH_ATTACHED : BATCH_FREE;
    s->batches[n] = (spring_batch){(int32_t)s->rows, (int32_t)count, held};
    s->rows += count;
    most = count > most ? count : most;
    if (held == BATCH_ATTACHED) s->held = HELD_MOST;
  }
  s->particles = s->held + 2 * most + draw_below(40);
  for (uint32_t n = 0; n < s->batch_count; ++n) make_batch(s, &s->batches[n]);
}

/* ---- places and speeds ---- */

static int32_t clamped(int64_t v, int64_t bound) {
  return (int32_t)(v < -bound ? -bound : (v > bound ? bound : v));
}

/* A difference of one axis, for a row whose rest length is `rest`, in units of 2^down. */
static int32_t some_difference(uint32_t way, int32_t rest, unsigned down, const double *toward) {
  const int32_t unit = 1 << down;
  switch (way) {
    case 0: return 0;
    case 1: return draw_between(-2 * rest, 2 * rest);
    case 2: return draw_between(-rest / unit, rest / unit) * unit + unit / 2; /* rounding's halves */
    case 3: return draw_either(1, -1) * (32767 * unit + draw_between(-300, 300));
    case 4: return draw_either(1, -1) * (int32_t)fmin(16383.0 * unit + draw_between(-300, 300), 2.0 * PLACE_MAX);
    case 5: return draw_either(1, -1) * 2 * PLACE_MAX;
    case 6: return draw_between(-2 * PLACE_MAX, 2 * PLACE_MAX);
    default: return (int32_t)lrint(*toward * rest);
  }
}

/* A direction, and how long in it. */
static void some_direction(double out[3]) {
  static const double lengths[] = {1, 1, 1, 0.75, 1.25, 0.5, 1.4142135, 0.1767767, 0.25, 2, 1.05, 1.1, 5};
  double squared = 0;
  for (int a = 0; a < 3; ++a) {
    out[a] = draw_below(4) == 0 ? 0 : draw_between(-1000, 1000);
    squared += out[a] * out[a];
  }
  const double to = lengths[draw_below(sizeof lengths / sizeof *lengths)] * (1 + draw_between(-50, 50) * 1e-5);
  for (int a = 0; a < 3; ++a) out[a] *= squared > 0 ? to / sqrt(squared) : 0;
}

static void place_row(sheet *s, uint32_t row, uint32_t ways) {
  const uint32_t kind = s->kind[row] & SPRING_CLASS;
  const int32_t rest = s->stage == SPRINGS ? s->springs[kind].rest
                       : s->stage == LOCKS ? s->links[CLASS_LOCK].rest
                                           : s->links[kind].rest;
  const unsigned down = s->stage == SPRINGS ? (unsigned)s->springs[kind].down : LINK_SHIFT;
  double toward[3];
  some_direction(toward);
  const uint32_t way = draw_below(ways);
  for (int a = 0; a < 3; ++a) {
    const int32_t d = some_difference(draw_below(4) == 0 ? draw_below(8) : way, rest, down, &toward[a]);
    int32_t *i = &s->x[a][s->i[row]];
    if (d > PLACE_MAX || d < -PLACE_MAX) *i = d > 0 ? -PLACE_MAX : PLACE_MAX;
    s->x[a][s->j[row]] = clamped((int64_t)*i + d, PLACE_MAX);
  }
}

static void make_places(sheet *s) {
  const int32_t spread = draw_either(PLACE_MAX, 1 << draw_between(4, 29));
  const uint32_t ways = 8u + 8u * draw_below(3);
  for (uint32_t p = 0; p < s->particles; ++p)
    for (int a = 0; a < 3; ++a) {
      s->x[a][p] = draw_between(-spread, spread);
      switch (draw_below(4)) {
        case 0: s->v[a][p] = draw_between(-FX_SPEED_MAX, FX_SPEED_MAX); break;
        case 1: s->v[a][p] = draw_either(1, -1) * (FX_SPEED_MAX - (int32_t)draw_below(1000)); break;
        case 2: s->v[a][p] = draw_either(1, -1) * (FX_SPEED_MAX - (int32_t)draw_below(1 << 29)); break;
        default: s->v[a][p] = draw_between(-2000, 2000); break;
      }
    }
  for (uint32_t row = 0; row < s->rows; ++row)
    if (s->kind[row] != SPRING_DEAD) place_row(s, row, ways);
}

/* ---- running them ---- */

static guarded memory_x[3], memory_v[3], memory_i, memory_j, memory_kind, memory_batches, memory_classes;

static void make_memory(void) {
  for (int a = 0; a < 3; ++a) {
    memory_x[a] = guarded_make(4 * PARTICLES_MOST);
    memory_v[a] = guarded_make(4 * PARTICLES_MOST);
  }
  memory_i = guarded_make(sizeof(index_t) * ROWS_MOST);
  memory_j = guarded_make(sizeof(index_t) * ROWS_MOST);
  memory_kind = guarded_make(ROWS_MOST);
  memory_batches = guarded_make(sizeof(spring_batch) * BATCHES_MOST);
  memory_classes = guarded_make(sizeof(bend_shear_class) * CLASSES_MOST);
}

static void *lent(guarded *g, const void *from, size_t bytes, int at_end) {
  return memcpy(guarded_place(g, bytes, at_end), from, bytes);
}
static int given_back(const guarded *g, const void *expected) {
  return memcmp(g->at, expected, g->bytes) == 0 && guarded_intact(g);
}

static void run_stage(const sheet *s, fray_world *w, fray_kernel kernel, body_motion *motion) {
  static params p;
  static const uint8_t grip_body[HELD_MOST];
  p.iterations = 1;
  p.attached = (int32_t)s->held;
  p.particles = (int32_t)s->particles;
  const int is_links = s->stage == LINKS || s->stage == TEARS;
  p.link_batches = is_links ? (int32_t)s->batch_count : 0;
  p.shear_batches = s->stage == LOCKS ? (int32_t)s->batch_count : 0;
  w->features.shear_lock = s->stage == LOCKS;
  p.bend_batches = s->stage == SPRINGS ? (int32_t)s->batch_count : 0;
  static index_t home[ROWS_MOST];
  for (uint32_t row = 0; row < s->rows; ++row) home[row] = (index_t)row;
  p.links = is_links ? (int32_t)s->rows : 0;
  p.tearing = 1;
  p.tear_min = s->tear_min;
  p.tear_max = s->tear_max;
  p.tears_max = CUTS_MOST;
  w->capacity[POOL_BATCHES] = s->batch_count;
  w->capacity[POOL_SPRINGS] = s->rows;
  w->p.count = s->particles;
  w->woven.canonical_id = home;
  w->kernel = kernel;
  w->params = &p;
  w->p.attach_body = grip_body;
  w->rigid.motion = motion;
  if (s->stage == SPRINGS)
    bend_shear_apply(w);
  else if (s->stage == TEARS)
    spring_tear_find(w);
  else
    strain_limit_apply(w);
}

static void run_scalar(sheet *s) {
  fray_world w = {0};
  w.p.x = s->x[0], w.p.y = s->x[1], w.p.z = s->x[2];
  w.p.vx = s->v[0], w.p.vy = s->v[1], w.p.vz = s->v[2];
  w.woven.spring_i = s->i, w.woven.spring_j = s->j, w.woven.spring_kind = s->kind;
  w.woven.batches = s->batches, w.woven.link_classes = s->links, w.woven.bend_shear_classes = s->springs;
  w.woven.tear_queue = s->cuts;
  run_stage(s, &w, FRAY_KERNEL_SCALAR, &s->motion);
  s->cut_count = w.woven.tear_count;
  s->over = w.work.over_threshold;
}

/* Returns 1 iff the kernel leaves everything as the scalar code left it in `expected`. */
static int run_kernel(const sheet *s, const sheet *expected, fray_kernel kernel, int at_end) {
  fray_world w = {0};
  body_motion motion = s->motion;
  torn_spring cuts[CUTS_MOST];
  const uint32_t words = 4 * s->particles;
  w.p.x = lent(&memory_x[0], s->x[0], words, at_end);
  w.p.y = lent(&memory_x[1], s->x[1], words, at_end);
  w.p.z = lent(&memory_x[2], s->x[2], words, at_end);
  w.p.vx = lent(&memory_v[0], s->v[0], words, at_end);
  w.p.vy = lent(&memory_v[1], s->v[1], words, at_end);
  w.p.vz = lent(&memory_v[2], s->v[2], words, at_end);
  w.woven.spring_i = lent(&memory_i, s->i, sizeof(index_t) * s->rows, at_end);
  w.woven.spring_j = lent(&memory_j, s->j, sizeof(index_t) * s->rows, at_end);
  w.woven.spring_kind = lent(&memory_kind, s->kind, s->rows, at_end);
  w.woven.batches = lent(&memory_batches, s->batches, sizeof(spring_batch) * s->batch_count, at_end);
  if (s->stage == SPRINGS)
    w.woven.bend_shear_classes = lent(&memory_classes, s->springs, sizeof(bend_shear_class) * s->classes, at_end);
  else
    w.woven.link_classes = lent(&memory_classes, s->links, sizeof(link_class) * s->classes, at_end);
  w.woven.tear_queue = cuts;
  run_stage(s, &w, kernel, &motion);
  int same = memcmp(&motion, &expected->motion, sizeof motion) == 0 &&
             w.woven.tear_count == expected->cut_count && w.work.over_threshold == expected->over &&
             memcmp(cuts, expected->cuts, sizeof(torn_spring) * w.woven.tear_count) == 0;
  for (int a = 0; a < 3; ++a)
    same = given_back(&memory_x[a], expected->x[a]) && given_back(&memory_v[a], expected->v[a]) && same;
  return given_back(&memory_i, s->i) && given_back(&memory_j, s->j) &&
         given_back(&memory_kind, s->kind) && given_back(&memory_batches, s->batches) &&
         given_back(&memory_classes, s->stage == SPRINGS ? (const void *)s->springs : s->links) && same;
}

static void rows_are_as_scalar(const char *name, uint32_t stage) {
  static sheet s, expected;
  fray_kernel kernels[SIMD_KERNELS];
  const uint32_t count = simd_kernels(kernels);
  uint64_t rows = 0, alive = 0, over = 0, different[SIMD_KERNELS] = {0};
  uint32_t cases = 0;
  uint32_t moved = 0; /* sheets that were not left as they were */
  s.stage = stage;
  for (; rows < rows_asked && count != 0; ++cases) {
    if (cases % CASES_A_CLASS == 0) make_classes(&s);
    make_batches(&s);
    make_places(&s);
    memset(&s.motion, 0, sizeof s.motion);
    s.tear_min = draw_below(4) == 0 ? draw_either(0, 1 << 18) : draw_between(0, 1 << draw_between(8, 18));
    s.tear_max = draw_between(s.tear_min, 1 << 18);
    expected = s;
    run_scalar(&expected);
    moved += memcmp(&expected, &s, sizeof s) != 0;
    for (uint32_t n = 0; n < count; ++n)
      if (!run_kernel(&s, &expected, kernels[n], cases % 2 == 0) && different[n]++ < 3)
        printf("%s: case %u differs from scalar\n", simd_kernel_names[kernels[n]], cases);
    for (uint32_t b = 0; b < s.batch_count; ++b)
      rows += s.batches[b].attached == BATCH_FREE ? (uint32_t)s.batches[b].count : 0;
    for (uint32_t row = 0; row < s.rows; ++row) alive += s.kind[row] != SPRING_DEAD;
    over += expected.over;
  }
  CHECK(moved > cases / 2 || count == 0);
  for (uint32_t n = 0; n < count; ++n) {
    printf("figure %s_as_scalar_%s %llu rows, sheets %u, alive %llu, over %llu, sheets that differ %llu (asked: 0)\n",
           name, simd_kernel_names[kernels[n]], (unsigned long long)rows, cases, (unsigned long long)alive,
           (unsigned long long)over, (unsigned long long)different[n]);
    CHECK_EQ_INT(different[n], 0);
  }
}

static void links_are_as_scalar(void) { rows_are_as_scalar("links", LINKS); }
static void springs_are_as_scalar(void) { rows_are_as_scalar("springs", SPRINGS); }
static void locks_are_as_scalar(void) { rows_are_as_scalar("locks", LOCKS); }
static void tears_are_as_scalar(void) { rows_are_as_scalar("tears", TEARS); }

int main(int argc, char **argv) {
  if (argc > 1) rows_asked = strtoull(argv[1], NULL, 10);
  make_memory();
  TEST(links_are_as_scalar);
  TEST(springs_are_as_scalar);
  TEST(tears_are_as_scalar);
  TEST(locks_are_as_scalar);
  return test_end();
}
