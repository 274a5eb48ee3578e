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
    "scene boxed\nrate 1000 Hz\n%s\n"
    "triangles {\n columns 8\n rows 16\n edge 1 cm\n mesh irregular 4\n material t-shirt\n drag 0.5 /s\n"
    " thickness 0.05 cm\n %s\n}\n"
    "mesh crate { obj \"tests/scenes/meshes/box.obj\" unit 1 cm at 0.4 -9 0.3 cm friction 0.3 }\n"
    "plane ground { at 0 -11 0 cm friction 0.5 }\n";
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
    uint32_t ticks;
  } cases[] = {{"folded", folded, 400}, {"boxed", boxed, 350}, {"torn", torn, 300}};
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
    CHECK(SWEEP_FEWER != 1 || r.passed > 5);
    CHECK_EQ_INT(r.pairs, 0);
    fixture_close(&f);
  }
}

int main(void) {
  TEST(nothing_passes);
  return test_end();
}
