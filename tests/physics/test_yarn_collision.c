/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns of a woven sheet do not pass through each other: after every tick the ways of all segments are
 * held against each other in exact arithmetic, but for those that share a particle or a crossing whose
 * yarns hold each other. Sheets that fall in folds, are torn, are all yarn; pools that are too small;
 * momentum; saves on the way. */
#include "tests/lib/test.h"

#include "rt/self_collision/self_collision.h"
#include "tests/lib/yarn_check.h"
#include "tests/physics/self_collision_check.h"
#include "tests/wild/body_depth.h"

enum { SEGMENTS_MOST = 4096 };

typedef struct {
  uint32_t p[2], crossing[2];
  span ways;
} segment;

static segment segments[SEGMENTS_MOST];

typedef struct {
  uint32_t passed, near, faults, stops, pairs;
  fray_output last;
} result;

/* A particle that was born in the tick began where its crossing was. */
static void begin_born(const fray_world *w, uint32_t before) {
  for (uint32_t p = before; p < w->p.count; ++p) began[p] = began[w->woven.crossing_particle[w->woven.crossing_of[p]]];
}

static uint32_t living(const fray_world *w) {
  uint32_t count = 0;
  for (uint32_t row = 0; row < (uint32_t)w->params->links; ++row) {
    segment *s = &segments[count];
    if (w->woven.spring_kind[row] == SPRING_DEAD) continue;
    if (++count == SEGMENTS_MOST) fixture_give_up("test_yarn_collision", "too many segments");
    s->p[0] = w->woven.spring_i[row];
    s->p[1] = w->woven.spring_j[row];
    yarn_grid_ends(world_yarn_grid(w), w->woven.canonical_id[row], &s->crossing[0], &s->crossing[1]);
    s->ways = span_of(w, s->p, 2);
  }
  return count;
}

/* From the middle of a segment that begins at number `from` of a yarn to the contact's place on it, spacings. */
static double off_middle(const fray_world *w, uint32_t crossing, fray_axis axis, uint32_t from) {
  const double place = w->woven.contacts[crossing_contact(w, crossing)].place[axis] * 0x1p-20 - 0.5;
  return fabs(place - (from + 0.5));
}

/* A warp's and a weft's segment near where their yarns slide over each other. */
static int slide_there(const fray_world *w, const segment *a, const segment *b) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const int a_is_warp = a->crossing[1] - a->crossing[0] == warps;
  const int b_is_warp = b->crossing[1] - b->crossing[0] == warps;
  const segment *warp = a_is_warp ? a : b;
  const segment *weft = a_is_warp ? b : a;
  if (!world_has_yarns(w) || a_is_warp == b_is_warp) return 0;
  const uint32_t c = weft->crossing[0] / warps * warps + warp->crossing[0] % warps;
  if (crossing_state_at(w, c) == FRAY_WHOLE || crossing_state_at(w, c) == FRAY_DISCONNECTED) return 0;
  return off_middle(w, c, FRAY_WEFT, weft->crossing[0] % warps) <= 1.5 &&
         off_middle(w, c, FRAY_WARP, warp->crossing[0] / warps) <= 1.5;
}

static int are_neighbours(const fray_world *w, const segment *a, const segment *b) {
  if (slide_there(w, a, b)) return 1;
  for (uint32_t n = 0; n < 4; ++n) {
    const uint32_t c = a->crossing[n / 2];
    if (a->p[n / 2] == b->p[n % 2]) return 1;
    if (c == b->crossing[n % 2] && (!world_has_yarns(w) || crossing_state_at(w, c) != FRAY_DISCONNECTED)) return 1;
  }
  return 0;
}

static void look(const fray_world *w, result *r) {
  const uint32_t count = living(w);
  for (uint32_t a = 0; a < count; ++a)
    for (uint32_t b = a + 1; b < count; ++b) {
      const segment *s = &segments[a];
      const segment *t = &segments[b];
      if (are_apart(&s->ways, &t->ways) || are_neighbours(w, s, t)) continue;
      const uint32_t of[4] = {s->p[0], s->p[1], t->p[0], t->p[1]};
      ++r->near;
      r->passed += passes(w, of, 0);
    }
}

/* Bodies that hold yarns, or a bound that is too low, say so. */
static result run(const char *name, fixture *f, uint32_t ticks) {
  result r = {0};
  CLOSED_BY(yarn_check_close) yarn_check k = {0};
  const fray_work most = fray_work_bound(f->w);
  if (world_has_yarns(f->w)) yarn_check_open(&k, f);
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    const uint32_t before = f->w->p.count;
    keep_begin(f->w);
    r.last = fixture_tick(f, &fixture_idle);
    begin_born(f->w, before);
    look(f->w, &r);
    r.faults |= r.last.faults;
    r.stops += r.last.work.self_merged;
    r.pairs += r.last.work.self_pairs;
    CHECK(fixture_within_bound(&r.last.work, &most));
    if (world_has_yarns(f->w)) yarn_check_tick(&k, f);
  }
  CHECK_EQ_INT(k.bad, 0);
  printf("figure selves_%s %u ways beside each other, %u touch, %u pairs found, %u particles moved as one, %u "
         "cuts, faults 0x%02X\n",
         name, r.near, r.passed, r.pairs, r.stops, r.last.tears_total, r.faults);
  return r;
}

/* It falls on its edge, in its own plane. */
static const char folded[] =
    "scene folded\nrate 1000 Hz\nsubsteps 4\nseed 3\n%s\n"
    "woven {\n warps 14\n wefts 14\n spacing 12 /cm\n tear off\n gather 20 %% pleats 3\n %s\n}\n"
    "plane ground { at 0 -0.6 0 cm friction 0.3 }\n";
/* It is drawn apart, tears and hits a ball. */
static const char torn[] =
    "scene torn\nrate 1000 Hz\nsubsteps 6\nseed 5\n%s\n"
    "woven {\n warps 14\n wefts 10\n spacing 12 /cm\n tear 4 8 %%\n drag 2 /s\n slip_friction 0.3\n"
    " yarns on\n %s\n}\n"
    "capsule left {\n radius 0.05 cm\n length 0.9 cm\n rotate 90 deg about z\n at -0.5417 0 0 cm\n attach_within 0.01 cm\n}\n"
    "capsule right {\n radius 0.05 cm\n length 0.9 cm\n rotate 90 deg about z\n at 0.5417 0 0 cm\n"
    " move path { 0 s 0.5417 0 0 cm  0.15 s 1.1417 0 0 cm  0.3 s -0.1 0.1 0.1 cm }\n attach_within 0.01 cm\n}\n"
    "plane ground { at 0 -0.7 0 cm friction 0.3 }\n";

static void nothing_passes(void) {
  static const struct {
    const char *name, *text, *more;
    uint32_t ticks;
  } cases[] = {{"folded", folded, "", 300},
               {"folded_yarns", folded, "yarns on\n", 250},
               {"torn", torn, "", 350},
               {"torn_twill", torn, "weave twill 2/2\n", 350}};
  for (uint32_t n = 0; n < sizeof cases / sizeof cases[0]; ++n) {
    fixture_scoped f = {0};
    char more[128];
    char name[64];
    snprintf(more, sizeof more, "%sself_collision on", cases[n].more);
    open_case(&f, cases[n].text, "limits { self_collision_pairs 40000 }", more);
    result r = run(cases[n].name, &f, cases[n].ticks);
    CHECK_EQ_INT(r.passed, 0);
    CHECK_EQ_INT(r.faults & FRAY_FAULT_SELF_COLLISION_BUDGET, 0);
    fixture_close(&f);
    snprintf(name, sizeof name, "%s_off", cases[n].name);
    open_case(&f, cases[n].text, "", cases[n].more);
    r = run(name, &f, cases[n].ticks);
    CHECK(r.passed > 20);
    CHECK_EQ_INT(r.pairs, 0);
  }
}

/* Every free particle went the same way in this tick. */
static uint32_t moved_as_one(const fray_world *w) {
  const uint32_t first = (uint32_t)w->params->attached;
  const vec3 way = vec_sub(world_position(w, first), began[first]);
  for (uint32_t p = first + 1; p < w->p.count; ++p)
    if (!vec_is_equal(vec_sub(world_position(w, p), began[p]), way)) return 0;
  return 1;
}

/* Too little room: that is said, what was found is pushed, the cloth goes on, and few pass of those that would. */
static void pools_of_any_size(void) {
  static const uint32_t sizes[] = {1, 2, 5, 20, 100};
  uint32_t free_to_pass[2];
  for (uint32_t n = 0; n < 2; ++n) {
    fixture_scoped f = {0};
    open_case(&f, n ? torn : folded, "", "");
    free_to_pass[n] = run(n ? "torn_250_off" : "folded_250_off", &f, 250).passed;
  }
  for (uint32_t n = 0; n < 2 * sizeof sizes / sizeof sizes[0]; ++n) {
    fixture_scoped f = {0};
    char limits[64];
    char name[64];
    snprintf(limits, sizeof limits, "limits { self_collision_pairs %u }", sizes[n / 2]);
    snprintf(name, sizeof name, "%s_pairs_%u", n % 2 ? "torn" : "folded", sizes[n / 2]);
    open_case(&f, n % 2 ? torn : folded, limits, "self_collision on");
    const result r = run(name, &f, 250);
    CHECK(r.passed * 20 < free_to_pass[n % 2]);
    CHECK(r.pairs > 0);
    CHECK((r.faults & FRAY_FAULT_SELF_COLLISION_BUDGET) != 0);
  }
}

/* Pleats fall over a rod: yarns that touch go back by the way of a tick, beside it. */
static void zones_keep_out_of_bodies(void) {
  fixture_scoped f = {0};
  double deepest = 0;
  fixture_text(&f, "scene over_rod\nrate 1000 Hz\nsubsteps 4\n"
                   "woven {\n warps 14\n wefts 18\n spacing 11.1901 /cm\n thickness 0.00386 cm\n density 0.03292 g/cm2\n"
                   " bend 7.542 g/s2\n shear 0.346 g/s2\n tear 2.52 3.48 %\n orientation vertical\n gather 15.6 %\n pleats 2\n"
                   " drag 0 /s\n self_collision on\n}\n"
                   "capsule rod {\n length 1.0006 cm\n radius 0.0599 cm\n rotate -62.4 deg about y\n friction 0.52\n"
                   " attach_within 0.0451 cm\n at -0.4173 -0.1731 0 cm\n}\n"
                   "plane ground {\n at 0 -1.0525 0 cm\n friction 0.72\n rotate 1.2 deg about x\n}\n");
  body_depth *depth = body_depth_open(f.w);
  uint32_t merged = 0;
  for (uint32_t tick = 0; tick < 400; ++tick) {
    merged += fixture_tick(&f, &fixture_idle).work.self_merged;
    deepest = fmax(deepest, body_depth_update(depth, f.w));
  }
  body_depth_close(depth);
  printf("figure selves_over_rod_depth %.3f of the cloth's thickness (asked: at most 1), %u particles moved as one\n",
         deepest / f.facts.thickness, merged);
  CHECK(deepest <= f.facts.thickness && merged > 100);
}

/* All yarn, crushed to a ball in which everything is near everything: the search meets its bound in each tick. It
 * says so and goes on. */
static void a_crushed_ball_opens(void) {
  fixture_scoped f = {0};
  uint64_t seed = 4;
  uint32_t stopped = 0, pushed = 0;
  uint32_t faults = 0;
  fixture_text(&f, "scene ball\nrate 1000 Hz\nsubsteps 4\nwoven { warps 20 wefts 20 spacing 12 /cm tear off yarns all "
               "self_collision on drag 5 /s }\n");
  fray_world *w = f.w;
  int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
  for (uint32_t p = 0; p < w->p.count; ++p)
    for (uint32_t k = 0; k < 3; ++k) at[k][p] = (int32_t)(splitmix64(&seed) % (1u << 22)) - (1 << 21);
  for (uint32_t tick = 0; tick < 100; ++tick) {
    keep_begin(w);
    const fray_output out = fixture_tick(&f, &fixture_idle);
    stopped += moved_as_one(w);
    pushed += out.work.self_ccd;
    faults |= out.faults;
  }
  printf("figure ball moved as one in %u of 100 ticks (asked: 0), %u tests, faults 0x%02X\n", stopped, pushed, faults);
  CHECK_EQ_INT(stopped, 0);
  CHECK(pushed > 1000);
  CHECK((faults & FRAY_FAULT_SELF_COLLISION_BUDGET) != 0);
}

/* The stage by itself, on sheets that nobody holds and whose particles go anywhere: momentum is the same to
 * the last bit, and nothing passes. */
static void momentum_is_kept(void) {
  uint64_t seed = 11;
  uint32_t pushed = 0;
  for (uint32_t n = 0; n < 200; ++n) {
    fixture_scoped f = {0};
    result r = {0};
    int64_t before[3];
    int64_t after[3];
    fixture_print(&f, "scene s\nrate 1000 Hz\nsubsteps 4\nwoven { warps 7 wefts 6 spacing 12 /cm tear off %s "
                  "self_collision on\n}\n", n % 2 ? "yarns all\n" : "yarns off\n");
    fray_world *w = f.w;
    const int32_t far = 1 << (17 + n % 6);
    yarn_collision_begin(w);
    keep_begin(w);
    throw_particles(w, far, 1, &seed);
    yarn_momentum(w, 0, before);
    yarn_collision_solve(w);
    yarn_momentum(w, 0, after);
    CHECK(memcmp(before, after, sizeof before) == 0);
    look(w, &r);
    CHECK_EQ_INT(r.passed, 0);
    pushed += w->work.self_ccd != 0;
  }
  CHECK(pushed > 60);
}

static void saved_in_the_middle(void) {
  fixture f;
  open_case(&f, torn, "", "self_collision on");
  saved_on_the_way(&f, 300, 30);
}

static void damaged_sections(void) {
  fixture_scoped f = {0};
  open_case(&f, folded, "", "self_collision on");
  CHECK(damage_each_bit(&f, IMAGE_YARN_COLLISION, 2) > 16);
}

int main(void) {
  TEST(nothing_passes);
  TEST(pools_of_any_size);
  TEST(zones_keep_out_of_bodies);
  TEST(a_crushed_ball_opens);
  TEST(momentum_is_kept);
  TEST(saved_in_the_middle);
  TEST(damaged_sections);
  return test_end();
}
