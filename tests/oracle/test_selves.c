/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns of a woven sheet do not pass through each other: after every tick the ways of all segments are
 * held against each other in exact arithmetic, but for those that share a particle or a crossing whose
 * yarns hold each other. Sheets that fall in folds, are torn, are all yarn; pools that are too small;
 * momentum; saves on the way. */
#include "tests/lib/test.h"

#include "rt/base/vec.h"
#include "tests/oracle/touching.h"

#include "rt/stage/stage.h"
#include "tests/lib/damage.h"
#include "tests/lib/yarn_check.h"

enum { SEGMENTS_MOST = 4096, PARTICLES_MOST = 4096 };

typedef struct {
  uint32_t p[2], crossing[2];
  int32_t low[2][3], high[2][3]; /* at the tick's begin, at its end */
} segment;

static vec3 began[PARTICLES_MOST];
static segment segments[SEGMENTS_MOST];

typedef struct {
  uint32_t passed, near, faults, stops, pairs;
  fray_output last;
} result;

static void keep_begin(const fray_world *w) {
  for (uint32_t p = 0; p < w->particles; ++p) began[p] = world_position(w, p);
}

/* A particle that was born in the tick began where its crossing was. */
static void begin_born(const fray_world *w, uint32_t before) {
  for (uint32_t p = before; p < w->particles; ++p) began[p] = began[w->crossing[w->place[p]]];
}

static uint32_t living(const fray_world *w) {
  uint32_t count = 0;
  for (uint32_t row = 0; row < (uint32_t)w->params->links; ++row) {
    segment *s = &segments[count];
    if (w->row_class[row] == ROW_DEAD) continue;
    if (++count == SEGMENTS_MOST) fixture_give_up("test_selves", "too many segments");
    s->p[0] = w->row_i[row];
    s->p[1] = w->row_j[row];
    weave_ends(world_weave(w), w->home[row], &s->crossing[0], &s->crossing[1]);
    for (uint32_t n = 0; n < 2; ++n) {
      const vec3 a = n != 0 ? world_position(w, s->p[0]) : began[s->p[0]];
      const vec3 b = n != 0 ? world_position(w, s->p[1]) : began[s->p[1]];
      const int32_t at[2][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}};
      for (uint32_t k = 0; k < 3; ++k) {
        s->low[n][k] = fx_min(at[0][k], at[1][k]);
        s->high[n][k] = fx_max(at[0][k], at[1][k]);
      }
    }
  }
  return count;
}

static int are_neighbours(const fray_world *w, const segment *a, const segment *b) {
  for (uint32_t n = 0; n < 4; ++n) {
    const uint32_t c = a->crossing[n / 2];
    if (a->p[n / 2] == b->p[n % 2]) return 1;
    if (c == b->crossing[n % 2] && (!world_has_yarns(w) || couple_at(w, c) != FRAY_DISCONNECTED)) return 1;
  }
  return 0;
}

/* One beyond the other along an axis, all the way. */
static int is_beyond(const segment *a, const segment *b) {
  for (uint32_t k = 0; k < 3; ++k)
    if (a->high[0][k] < b->low[0][k] && a->high[1][k] < b->low[1][k]) return 1;
  return 0;
}

/* On their ways; what touched when the tick began, as yarns of one crossing may that comes apart, has no
 * side to leave. */
static int touch(const fray_world *w, const segment *a, const segment *b) {
  way ways[4];
  way still[4];
  for (uint32_t n = 0; n < 4; ++n) {
    const uint32_t p = n < 2 ? a->p[n] : b->p[n - 2];
    const vec3 end = world_position(w, p);
    const way made = {{began[p].x, began[p].y, began[p].z}, {end.x, end.y, end.z}};
    ways[n] = still[n] = made;
    memcpy(still[n].end, made.begin, sizeof made.begin);
  }
  return touching(ways, 0) && !touching(still, 0);
}

static int is_held(const fray_world *w, const segment *s) {
  return s->p[0] < (uint32_t)w->params->held || s->p[1] < (uint32_t)w->params->held;
}

static void look(const fray_world *w, result *r) {
  const uint32_t count = living(w);
  for (uint32_t a = 0; a < count; ++a)
    for (uint32_t b = a + 1; b < count; ++b) {
      const segment *s = &segments[a];
      const segment *t = &segments[b];
      if (is_beyond(s, t) || is_beyond(t, s) || are_neighbours(w, s, t)) continue;
      ++r->near;
      /* bodies carry what they hold through what moves as one */
      if ((w->state->faults & (int32_t)FRAY_FAULT_SELVES) != 0 && (is_held(w, s) || is_held(w, t))) continue;
      r->passed += (uint32_t)touch(w, s, t);
    }
}

/* Bodies that hold yarns, or a bound that is too low, say so. */
static result run(const char *name, fixture *f, uint32_t ticks) {
  result r;
  yarn_check k;
  const fray_work most = fray_limits(f->w);
  memset(&r, 0, sizeof r);
  if (world_has_yarns(f->w)) yarn_check_open(&k, f);
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    const uint32_t before = f->w->particles;
    keep_begin(f->w);
    r.last = fixture_tick(f, &fixture_idle);
    begin_born(f->w, before);
    look(f->w, &r);
    r.faults |= r.last.faults;
    r.stops += r.last.work.self_stops;
    r.pairs += r.last.work.self_pairs;
    CHECK(fixture_within(&r.last.work, &most));
    if (world_has_yarns(f->w)) yarn_check_tick(&k, f);
  }
  if (world_has_yarns(f->w)) {
    CHECK_EQ_INT(k.bad, 0);
    yarn_check_close(&k);
  }
  printf("figure selves_%s %u ways beside each other, %u touch, %u pairs found, %u particles moved as one, %u "
         "cuts, faults 0x%02X\n",
         name, r.near, r.passed, r.pairs, r.stops, r.last.cuts_total, r.faults);
  return r;
}

/* It falls on its edge, in its own plane. */
static const char folded[] =
    "scene folded\nrate 1000 Hz\nsubsteps 4\nseed 3\n%s\n"
    "sheet {\n warps 14\n wefts 14\n spacing 12 /cm\n tear off\n gather 20 %% pleats 3\n %s\n}\n"
    "plane ground { at 0 -0.6 0 cm friction 0.3 }\n";
/* It is drawn apart, tears and hits a ball. */
static const char torn[] =
    "scene torn\nrate 1000 Hz\nsubsteps 6\nseed 5\n%s\n"
    "sheet {\n warps 14\n wefts 10\n spacing 12 /cm\n tear 4 8 %%\n drag 2 /s\n slip_friction 0.3\n"
    " yarns on\n %s\n}\n"
    "bar left {\n radius 0.05 cm\n length 0.9 cm\n turn 90 deg about z\n at -0.5417 0 0 cm\n grip 0.01 cm\n}\n"
    "bar right {\n radius 0.05 cm\n length 0.9 cm\n turn 90 deg about z\n at 0.5417 0 0 cm\n"
    " move path { 0 s 0.5417 0 0 cm  0.15 s 1.1417 0 0 cm  0.3 s -0.1 0.1 0.1 cm }\n grip 0.01 cm\n}\n"
    "plane ground { at 0 -0.7 0 cm friction 0.3 }\n";

static void open_case(fixture *f, const char *text, const char *limits, const char *more) {
  char scene_text[4096];
  snprintf(scene_text, sizeof scene_text, text, limits, more);
  fixture_text(f, scene_text);
}

static void nothing_passes(void) {
  static const struct {
    const char *name, *text, *more;
    uint32_t ticks;
  } cases[] = {{"folded", folded, "", 300},
               {"folded_yarns", folded, "yarns on\n", 250},
               {"torn", torn, "", 350},
               {"torn_twill", torn, "weave twill 2/2\n", 350}};
  for (uint32_t n = 0; n < sizeof cases / sizeof cases[0]; ++n) {
    fixture f;
    char more[128];
    char name[64];
    snprintf(more, sizeof more, "%sself_collision on", cases[n].more);
    open_case(&f, cases[n].text, "limits { self_pairs 40000 }", more);
    result r = run(cases[n].name, &f, cases[n].ticks);
    CHECK_EQ_INT(r.passed, 0);
    CHECK_EQ_INT(r.faults & FRAY_FAULT_SELVES, 0);
    fixture_close(&f);
    snprintf(name, sizeof name, "%s_off", cases[n].name);
    open_case(&f, cases[n].text, "", cases[n].more);
    r = run(name, &f, cases[n].ticks);
    CHECK(r.passed > 20);
    CHECK_EQ_INT(r.pairs, 0);
    fixture_close(&f);
  }
}

/* Too little room: what was not found moves as one, and that is said. */
static void pools_of_any_size(void) {
  static const uint32_t sizes[] = {1, 2, 5, 20, 100};
  for (uint32_t n = 0; n < 2 * sizeof sizes / sizeof sizes[0]; ++n) {
    fixture f;
    char limits[64];
    char name[64];
    snprintf(limits, sizeof limits, "limits { self_pairs %u }", sizes[n / 2]);
    snprintf(name, sizeof name, "%s_pairs_%u", n % 2 ? "torn" : "folded", sizes[n / 2]);
    open_case(&f, n % 2 ? torn : folded, limits, "self_collision on");
    const result r = run(name, &f, 250);
    CHECK_EQ_INT(r.passed, 0);
    CHECK(sizes[n / 2] > 5 || (r.faults & FRAY_FAULT_SELVES) != 0);
    fixture_close(&f);
  }
}

static void momentum_of(const fray_world *w, int64_t sum[3]) {
  sum[0] = sum[1] = sum[2] = 0;
  for (uint32_t p = 0; p < w->particles; ++p) {
    const int64_t mass = world_has_yarns(w) && couple_is_light(w, p) ? 1 : 2;
    sum[0] += mass * w->vx[p];
    sum[1] += mass * w->vy[p];
    sum[2] += mass * w->vz[p];
  }
}

/* The stage by itself, on sheets that nobody holds and whose particles go anywhere: momentum is the same to
 * the last bit, and nothing passes. */
static void momentum_is_kept(void) {
  uint64_t seed = 11;
  uint32_t pushed = 0;
  for (uint32_t n = 0; n < 200; ++n) {
    fixture f;
    result r;
    int64_t before[3];
    int64_t after[3];
    memset(&r, 0, sizeof r);
    fixture_print(&f, "scene s\nrate 1000 Hz\nsubsteps 4\nsheet { warps 7 wefts 6 spacing 12 /cm tear off %s "
                  "self_collision on\n}\n", n % 2 ? "yarns all\n" : "yarns off\n");
    fray_world *w = f.w;
    const int32_t far = 1 << (17 + n % 6);
    selves_begin(w);
    keep_begin(w);
    for (uint32_t p = 0; p < w->particles; ++p) {
      w->x[p] += (int32_t)(fixture_random(&seed) % (2u * (uint32_t)far)) - far;
      w->y[p] += (int32_t)(fixture_random(&seed) % (2u * (uint32_t)far)) - far;
      w->z[p] += (int32_t)(fixture_random(&seed) % (2u * (uint32_t)far)) - far;
      w->vx[p] = w->x[p] - began[p].x;
      w->vy[p] = w->y[p] - began[p].y;
      w->vz[p] = w->z[p] - began[p].z;
    }
    momentum_of(w, before);
    selves_run(w);
    momentum_of(w, after);
    CHECK(memcmp(before, after, sizeof before) == 0);
    look(w, &r);
    CHECK_EQ_INT(r.passed, 0);
    pushed += w->work.self_sweeps != 0;
    fixture_close(&f);
  }
  CHECK(pushed > 60);
}

/* Saved at any moment and opened again: the same from there on. */
static void saved_in_the_middle(void) {
  fixture f;
  fixture other;
  open_case(&f, torn, "", "self_collision on");
  for (uint32_t tick = 0; tick < 300; ++tick) {
    fixture_tick(&f, &fixture_idle);
    if (tick % 30 != 29) continue;
    fixture_copy(&other, &f);
    for (uint32_t n = 0; n < 20; ++n)
      CHECK(fixture_tick(&f, &fixture_idle).hash == fixture_tick(&other, &fixture_idle).hash);
    fixture_close(&f);
    f = other;
  }
  fixture_close(&f);
}

static void damaged_sections(void) {
  fixture f;
  open_case(&f, folded, "", "self_collision on");
  CHECK_EQ_INT(f.image[4], 4); /* version 2.4 */
  CHECK(damage_each_bit(&f, IMAGE_SELVES, 2) > 16);
  fixture_close(&f);
}

int main(void) {
  TEST(nothing_passes);
  TEST(pools_of_any_size);
  TEST(momentum_is_kept);
  TEST(saved_in_the_middle);
  TEST(damaged_sections);
  return test_end();
}
