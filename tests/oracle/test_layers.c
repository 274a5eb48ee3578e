/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles of a sheet do not pass through each other: after every tick the ways of all vertices against all
 * triangles, and of all sides against all others, in exact arithmetic. Sheets that fall in folds on themselves and
 * on boxes, are torn, are cut, are crumpled at random; the list of what is near each other made anew in every tick
 * or kept, which is the same to the last bit; pools that are too small; momentum; saves on the way. */
#include "tests/lib/test.h"

#include "rt/base/vec.h"
#include "tests/oracle/touching.h"

#include "rt/base/bytes.h"
#include "rt/stage/stage.h"
#include "tests/lib/damage.h"
#include "tests/lib/sheet_check.h"
#include "tests/lib/world_fixture.h"

#ifndef SWEEP_FEWER
#define SWEEP_FEWER 1
#endif

enum { PARTICLES_MOST = 4096, TRIANGLES_MOST = 4096, SIDES_MOST = 3 * TRIANGLES_MOST };

/* What ways take up at the tick's begin and at its end. */
typedef struct {
  int32_t low[2][3], high[2][3];
} span;

static vec3 began[PARTICLES_MOST];
static span points[PARTICLES_MOST], faces[TRIANGLES_MOST], sides[SIDES_MOST];
static uint32_t ends[SIDES_MOST][2], side_count;

typedef struct {
  uint32_t passed, near, faults, stops, pairs, cuts;
  fray_output last;
} result;

static void keep_begin(const fray_world *w) {
  for (uint32_t p = 0; p < w->particles; ++p) began[p] = world_position(w, p);
}

static span span_of(const fray_world *w, const uint32_t *p, uint32_t count) {
  span s;
  for (uint32_t n = 0; n < 2; ++n)
    for (uint32_t m = 0; m < count; ++m) {
      const vec3 at = n != 0 ? world_position(w, p[m]) : began[p[m]];
      const int32_t x[3] = {at.x, at.y, at.z};
      for (uint32_t k = 0; k < 3; ++k) {
        s.low[n][k] = m == 0 ? x[k] : fx_min(s.low[n][k], x[k]);
        s.high[n][k] = m == 0 ? x[k] : fx_max(s.high[n][k], x[k]);
      }
    }
  return s;
}

/* One beyond the other along an axis, all the way. */
static int is_beyond(const span *a, const span *b) {
  for (uint32_t k = 0; k < 3; ++k)
    if (a->high[0][k] < b->low[0][k] && a->high[1][k] < b->low[1][k]) return 1;
  return 0;
}
static int are_apart(const span *a, const span *b) { return is_beyond(a, b) || is_beyond(b, a); }

/* They were one before a tear, and are not yet apart by the thickness; or are one. */
static int is_one(const fray_world *w, uint32_t p, uint32_t q) {
  const sheet_mesh *s = &w->sheet;
  const int64_t most = w->selves != NULL ? w->selves->thickness : 0;
  const int64_t x = (int64_t)began[p].x - began[q].x;
  const int64_t y = (int64_t)began[p].y - began[q].y;
  const int64_t z = (int64_t)began[p].z - began[q].z;
  return p == q || (s->u[p] == s->u[q] && s->v[p] == s->v[q] && llabs(x) <= most && llabs(y) <= most && llabs(z) <= most);
}

/* On their ways; what touched when the tick began has no side to leave. */
static int touch(const fray_world *w, const uint32_t p[4], int triangle) {
  way ways[4];
  way still[4];
  for (uint32_t n = 0; n < 4; ++n) {
    const vec3 end = world_position(w, p[n]);
    const way made = {{began[p[n]].x, began[p[n]].y, began[p[n]].z}, {end.x, end.y, end.z}};
    ways[n] = still[n] = made;
    memcpy(still[n].end, made.begin, sizeof made.begin);
  }
  return touching(ways, triangle) && !touching(still, triangle);
}

static int has_held(const fray_world *w, const uint32_t p[4]) {
  for (uint32_t n = 0; n < 4; ++n)
    if (p[n] < (uint32_t)w->params->held) return 1;
  return 0;
}

static void hold_against(const fray_world *w, const uint32_t p[4], uint32_t firsts, result *r) {
  for (uint32_t m = 0; m < firsts; ++m)
    for (uint32_t n = firsts; n < 4; ++n)
      if (is_one(w, p[m], p[n])) return;
  ++r->near;
  /* bodies carry what they hold through what moves as one */
  if ((w->state->faults & (int32_t)FRAY_FAULT_SELVES) != 0 && has_held(w, p)) return;
  r->passed += (uint32_t)touch(w, p, firsts == 1);
}

static void list_all(const fray_world *w) {
  const sheet_mesh *s = &w->sheet;
  side_count = 0;
  for (uint32_t p = 0; p < w->particles; ++p) points[p] = span_of(w, &p, 1);
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    const uint32_t v[3] = {s->triangle[t].v[0], s->triangle[t].v[1], s->triangle[t].v[2]};
    faces[t] = span_of(w, v, 3);
    for (uint32_t k = 0; k < 3; ++k) {
      if (s->triangle[t].across[k] < t) continue;
      ends[side_count][0] = v[sheet_next(k)];
      ends[side_count][1] = v[sheet_last(k)];
      sides[side_count] = span_of(w, ends[side_count], 2);
      ++side_count;
    }
  }
}

static void look(const fray_world *w, result *r) {
  list_all(w);
  for (uint32_t t = 0; t < (uint32_t)w->sheet.state->triangles; ++t)
    for (uint32_t p = 0; p < w->particles; ++p) {
      if (are_apart(&points[p], &faces[t])) continue;
      const row_id *v = w->sheet.triangle[t].v;
      const uint32_t of[4] = {p, v[0], v[1], v[2]};
      hold_against(w, of, 1, r);
    }
  for (uint32_t a = 0; a < side_count; ++a)
    for (uint32_t b = a + 1; b < side_count; ++b) {
      if (are_apart(&sides[a], &sides[b])) continue;
      const uint32_t of[4] = {ends[a][0], ends[a][1], ends[b][0], ends[b][1]};
      hold_against(w, of, 2, r);
    }
}

/* Of `every` ticks one is looked at. */
static result run(const char *name, fixture *f, uint32_t ticks, uint32_t every) {
  result r;
  sheet_check k;
  const fray_work most = fray_limits(f->w);
  memset(&r, 0, sizeof r);
  sheet_check_open(&k, f->w);
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    const uint32_t before = f->w->particles;
    keep_begin(f->w);
    r.last = fixture_tick(f, &fixture_idle);
    r.faults |= r.last.faults;
    r.stops += r.last.work.self_stops;
    r.pairs += r.last.work.self_pairs;
    CHECK(fixture_within(&r.last.work, &most));
    sheet_check_sums(f->w, &k.area, k.momentum); /* forces change it */
    sheet_check_now(&k, f->w);
    /* vertices that are born in a tick begin where they are put, which only the stage knows */
    for (uint32_t p = before; p < f->w->particles && f->w->selves != NULL; ++p) began[p] = f->w->ways[p].begin;
    if (tick % every == 0 && (before == f->w->particles || f->w->selves != NULL)) look(f->w, &r);
  }
  r.cuts = r.last.cuts_total;
  CHECK_EQ_INT(k.bad, 0);
  printf("figure layers_%s %u ways beside each other, %u touch, %u pairs found, %u vertices moved as one, %u cuts, "
         "faults 0x%02X\n", name, r.near, r.passed, r.pairs, r.stops, r.cuts, r.faults);
  return r;
}

/* It falls on its edge and folds; on the ground; on a box. */
static const char folded[] =
    "scene folded\nrate 1000 Hz\nwind 0 0 1 m/s\n%s\n"
    "triangles {\n columns 10\n rows 12\n edge 1 cm\n mesh irregular 3\n material t-shirt\n drag 0.5 /s\n"
    " thickness 0.05 cm\n %s\n}\n"
    "plane ground { at 0 -6.5 0 cm friction 0.5 }\n";
static const char boxed[] =
    "scene boxed\nrate 1000 Hz\nsubsteps 4\n%s\n"
    "triangles {\n columns 10\n rows 14\n edge 1 cm\n mesh irregular 3\n material cotton\n drag 1 /s\n inner_steps 32\n"
    " at 0.4 9 -0.7 cm\n thickness 0.08 cm\n %s\n}\n"
    "material cotton { like t-shirt stretch all 120 20 100 40 N/m }\n"
    "mesh crate { obj \"tests/scenes/meshes/box.obj\" unit 2.5 cm at 0 0 0 cm turn 20 deg about y friction 0.8 }\n"
    "plane ground { at 0 -2 0 cm }\n";
/* A strip falls in folds on itself between two walls, and comes to rest. */
static const char heap[] =
    "scene heap\nrate 1000 Hz\nsubsteps 4\nwind 0.3 0 1 m/s\n%s\n"
    "triangles {\n columns 5\n rows 30\n edge 1 cm\n mesh irregular 3\n material t-shirt\n drag 2 /s\n inner_steps 32\n"
    " thickness 0.05 cm\n %s\n}\n"
    "box wall { size 40 40 2 cm at 0 -4 2 cm friction 0.3 }\nbox hind { size 40 40 2 cm at 0 -4 -2.5 cm friction 0.3 }\n"
    "plane ground { at 0 -16 0 cm friction 0.8 }\n";
static const char slashed[] =
    "scene slashed\nrate 1000 Hz\nsubsteps 2\nwind 0 0 2 m/s\n%s\n"
    "triangles {\n columns 10\n rows 9\n edge 1 cm\n mesh irregular 3\n material rag\n drag 1 /s\n strain_limit 40 %%\n"
    " thickness 0.05 cm\n %s\n}\n"
    "material rag { like t-shirt stretch all 90 15 110 40 N/m tear 8 N/m relax 2 ms cut 0.4 m/s }\n"
    "pin row top\n"
    "mesh blade { obj \"tests/scenes/meshes/sword.obj\" turn 90 deg about x sharp named friction 0.1\n"
    " move path { 0 s -8 0.6 2 cm  0.01 s -8 0.6 2 cm  0.08 s 8 -0.3 2.2 cm } }\n";
static const char torn[] =
    "scene torn\nrate 1000 Hz\nwind 4 0 2 m/s\n%s\n"
    "triangles {\n columns 12\n rows 9\n edge 2 cm\n mesh irregular 6\n material rag\n drag 0.5 /s\n strain_limit 40 %%\n"
    " thickness 0.05 cm\n %s\n}\n"
    "material rag { like t-shirt tear 4 6 8 6 N/m relax 1 ms }\n"
    "pin column left\npin column right\nball iron { radius 1.5 cm at 4 1 -4 cm move free mass 200 g velocity 0 0 200 cm/s }\n";

static void open_case(fixture *f, const char *text, const char *limits, const char *more) {
  static char scene_text[4096];
  snprintf(scene_text, sizeof scene_text, text, limits, more);
  fixture_text(f, scene_text);
}

static void nothing_passes(void) {
  static const struct {
    const char *name, *text;
    uint32_t ticks, passes; /* so many without it, at least */
  } cases[] = {{"folded", folded, 400, 10},
               {"heap", heap, 900, 10},
               {"boxed", boxed, 600, 10},
               {"torn", torn, 300, 10},
               {"slashed", slashed, 250, 0}};
  for (uint32_t n = 0; n < sizeof cases / sizeof cases[0]; ++n) {
    fixture f;
    char name[64];
    const uint32_t ticks = cases[n].ticks / (SWEEP_FEWER == 1 ? 1 : 4);
    open_case(&f, cases[n].text, "limits { contacts 2000 }", "self_collision on");
    result r = run(cases[n].name, &f, ticks, SWEEP_FEWER);
    CHECK_EQ_INT(r.passed, 0);
    CHECK_EQ_INT(r.faults & (FRAY_FAULT_SELVES | FRAY_FAULT_JAMMED), 0);
    fixture_close(&f);
    snprintf(name, sizeof name, "%s_off", cases[n].name);
    open_case(&f, cases[n].text, "limits { contacts 2000 }", "");
    r = run(name, &f, ticks, 4 * SWEEP_FEWER);
    CHECK(SWEEP_FEWER != 1 || r.passed >= cases[n].passes);
    CHECK_EQ_INT(r.pairs, 0);
    fixture_close(&f);
  }
}

/* Too little room: what was not found moves as one, and that is said. */
static void pools_of_any_size(void) {
  static const uint32_t sizes[] = {1, 2, 5, 20, 60};
  for (uint32_t n = 0; n < 2 * sizeof sizes / sizeof sizes[0]; ++n) {
    fixture f;
    char limits[64];
    char name[64];
    snprintf(limits, sizeof limits, "limits { contacts 2000 self_pairs %u }", sizes[n / 2]);
    snprintf(name, sizeof name, "%s_pairs_%u", n % 2 ? "torn" : "folded", sizes[n / 2]);
    open_case(&f, n % 2 ? torn : folded, limits, "self_collision on");
    const result r = run(name, &f, 300, 2 * SWEEP_FEWER);
    CHECK_EQ_INT(r.passed, 0);
    CHECK(sizes[n / 2] > 5 || (r.faults & FRAY_FAULT_SELVES) != 0);
    fixture_close(&f);
  }
}

/* What is near each other listed anew in every tick, or kept: the same to the last bit. Visits and sweeps are not
 * the state's; what was found to meet is. */
static void the_list_is_no_state(void) {
  static const char *const texts[] = {folded, heap, torn, slashed};
  static const char *const limits[] = {"limits { contacts 2000 }", "limits { contacts 2000 self_pairs 90 }"};
  for (uint32_t n = 0; n < 8; ++n) {
    fixture kept;
    fixture anew;
    uint32_t visits[2] = {0, 0};
    uint32_t met = 0;
    uint32_t differ = 0;
    open_case(&kept, texts[n / 2], limits[n % 2], "self_collision on");
    open_case(&anew, texts[n / 2], limits[n % 2], "self_collision on");
    for (uint32_t tick = 0; tick < 500; ++tick) {
      anew.w->listed->kept = 0;
      const fray_output a = fixture_tick(&kept, &fixture_idle);
      const fray_output b = fixture_tick(&anew, &fixture_idle);
      differ += a.hash != b.hash || a.work.self_pairs != b.work.self_pairs || a.work.self_stops != b.work.self_stops ||
                a.faults != b.faults;
      met += a.work.self_pairs;
      visits[0] += a.work.self_visits;
      visits[1] += b.work.self_visits;
    }
    CHECK_EQ_INT(differ, 0);
    CHECK(met > 100);
    printf("figure layers_list_%u %u met, %u visits with a list that is kept, %u without\n", n, met, visits[0], visits[1]);
    fixture_close(&kept);
    fixture_close(&anew);
  }
}

static int is_in_world(const fray_world *w) {
  for (uint32_t p = 0; p < w->particles; ++p)
    if (abs(w->vx[p]) > FX_SPEED_MAX || abs(w->vy[p]) > FX_SPEED_MAX || abs(w->vz[p]) > FX_SPEED_MAX) return 0;
  return 1;
}

/* The stage by itself, on sheets that nobody holds and whose vertices go anywhere: momentum is the same to the
 * last bit, and nothing passes. */
static void momentum_is_kept(void) {
  uint64_t seed = 11;
  uint32_t pushed = 0;
  uint32_t joined = 0;
  for (uint32_t n = 0; n < 200 / SWEEP_FEWER; ++n) {
    fixture f;
    result r;
    uint64_t area;
    int64_t before[3];
    int64_t after[3];
    memset(&r, 0, sizeof r);
    fixture_print(&f, "scene s\nrate 1000 Hz\ntriangles { columns 5 rows 4 edge 1 cm mesh irregular %u material denim "
                      "thickness 0.05 cm self_collision on }\n", n);
    fray_world *w = f.w;
    const int32_t far = 1 << (17 + n % 6);
    (void)fixture_tick(&f, &fixture_idle); /* vertices get their masses */
    layers_begin(w);
    keep_begin(w);
    memset(&w->work, 0, sizeof w->work);
    for (uint32_t p = 0; p < w->particles; ++p) {
      w->x[p] += (int32_t)(fixture_random(&seed) % (2u * (uint32_t)far)) - far;
      w->y[p] += (int32_t)(fixture_random(&seed) % (2u * (uint32_t)far)) - far;
      w->z[p] += (int32_t)(fixture_random(&seed) % (2u * (uint32_t)far)) - far;
      w->vx[p] = 16 * (w->x[p] - began[p].x);
      w->vy[p] = 16 * (w->y[p] - began[p].y);
      w->vz[p] = 16 * (w->z[p] - began[p].z);
    }
    sheet_check_sums(w, &area, before);
    layers_run(w);
    sheet_check_sums(w, &area, after);
    CHECK(memcmp(before, after, sizeof before) == 0);
    CHECK(is_in_world(w));
    look(w, &r);
    CHECK_EQ_INT(r.passed, 0);
    pushed += w->work.self_sweeps != 0;
    joined += w->work.self_stops != 0;
    fixture_close(&f);
  }
  printf("figure layers_momentum of %u crumpled sheets %u met themselves, %u were joined\n", 200 / SWEEP_FEWER, pushed, joined);
  CHECK(pushed > 60 / SWEEP_FEWER && joined > 20 / SWEEP_FEWER);
}

/* Saved at any moment and opened again: the same from there on. */
static void saved_in_the_middle(void) {
  static const char *const texts[] = {folded, torn, slashed};
  for (uint32_t n = 0; n < 3; ++n) {
    fixture f;
    fixture other;
    open_case(&f, texts[n], "limits { contacts 2000 }", "self_collision on");
    for (uint32_t tick = 0; tick < 400; ++tick) {
      fixture_tick(&f, &fixture_idle);
      if (tick % 40 != 39) continue;
      fixture_copy(&other, &f);
      for (uint32_t k = 0; k < 20; ++k)
        CHECK(fixture_tick(&f, &fixture_idle).hash == fixture_tick(&other, &fixture_idle).hash);
      fixture_close(&f);
      f = other;
    }
    fixture_close(&f);
  }
}

static void damaged_sections(void) {
  fixture f;
  open_case(&f, folded, "", "self_collision on");
  CHECK_EQ_INT(f.image[4], 7); /* version 2.7 */
  CHECK(damage_each_bit(&f, IMAGE_LAYERS, 2) > 16);
  fixture_close(&f);
}

/* A header that calls for what the image has not, or has what no other section goes with. */
static void headers_that_lie(void) {
  static const struct {
    uint32_t word, value;
    fray_status status;
  } lies[] = {{IMAGE_CAPACITY_WORD + POOL_LAYERS, 0, FRAY_BAD_SECTION},
              {IMAGE_CAPACITY_WORD + POOL_LAYERS, LIMIT_LAYERS + 1, FRAY_BAD_FIELD},
              {IMAGE_CAPACITY_WORD + POOL_PAIRS, 5, FRAY_BAD_SECTION},
              {IMAGE_CAPACITY_WORD + POOL_TRIANGLES, 0, FRAY_BAD_SECTION},
              {IMAGE_VERSION_WORD, FRAY_IMAGE_MAJOR << 16 | 6u, FRAY_BAD_VERSION}};
  for (uint32_t n = 0; n < sizeof lies / sizeof lies[0]; ++n) {
    fixture f;
    fray_world *w;
    fray_error error;
    open_case(&f, folded, "", "self_collision on");
    bytes_store32(f.image + 4 * lies[n].word, lies[n].value);
    CHECK_EQ_INT(damage_open(&f, &w, &error), lies[n].status);
    fixture_close(&f);
  }
}

/* The heap, for 60 s. */
static void a_minute(void) {
  fixture f;
  open_case(&f, heap, "limits { contacts 2000 }", "self_collision on");
  const result r = run("minute", &f, 60000, 50);
  CHECK_EQ_INT(r.passed, 0);
  CHECK_EQ_INT(r.faults & FRAY_FAULT_SELVES, 0);
  fixture_close(&f);
}

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "all") == 0) TEST(a_minute);
  TEST(nothing_passes);
  TEST(pools_of_any_size);
  TEST(the_list_is_no_state);
  TEST(momentum_is_kept);
  TEST(saved_in_the_middle);
  TEST(damaged_sections);
  TEST(headers_that_lie);
  return test_end();
}
