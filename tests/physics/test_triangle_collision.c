/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles of a sheet do not pass through each other: after every tick the ways of all vertices against all
 * triangles, and of all sides against all others, in exact arithmetic. Sheets that fall in folds on themselves and
 * on boxes, are torn, are cut, are crumpled at random; the list of what is near each other made anew in every tick
 * or kept, which is the same to the last bit; pools that are too small; momentum; saves on the way. */
#include <math.h>

#include "tests/lib/test.h"

#include "rt/base/bytes.h"
#include "rt/self_collision/self_collision.h"
#include "tests/lib/trimesh_check.h"
#include "tests/physics/self_collision_check.h"

enum { TRIANGLES_MOST = 4096, SIDES_MOST = 3 * TRIANGLES_MOST };

static span points[PARTICLES_MOST], faces[TRIANGLES_MOST], sides[SIDES_MOST];
static uint32_t ends[SIDES_MOST][2], side_count;

typedef struct {
  uint32_t passed, near, faults, stops, pairs, cuts;
  fray_output last;
} result;

/* They were one before a tear, and are not yet apart by the thickness; or are one. */
static int is_one(const fray_world *w, uint32_t p, uint32_t q) {
  const trimesh *s = &w->trimesh;
  const int64_t most = w->self.constants != NULL ? w->self.constants->thickness : 0;
  const int64_t x = (int64_t)began[p].x - began[q].x;
  const int64_t y = (int64_t)began[p].y - began[q].y;
  const int64_t z = (int64_t)began[p].z - began[q].z;
  return p == q || (s->u[p] == s->u[q] && s->v[p] == s->v[q] && llabs(x) <= most && llabs(y) <= most && llabs(z) <= most);
}

static void hold_against(const fray_world *w, const uint32_t p[4], uint32_t firsts, result *r) {
  for (uint32_t m = 0; m < firsts; ++m)
    for (uint32_t n = firsts; n < 4; ++n)
      if (is_one(w, p[m], p[n])) return;
  ++r->near;
  r->passed += passes(w, p, firsts == 1);
}

static void list_all(const fray_world *w) {
  const trimesh *s = &w->trimesh;
  side_count = 0;
  for (uint32_t p = 0; p < w->p.count; ++p) points[p] = span_of(w, &p, 1);
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    const uint32_t v[3] = {s->triangle[t].v[0], s->triangle[t].v[1], s->triangle[t].v[2]};
    faces[t] = span_of(w, v, 3);
    for (uint32_t k = 0; k < 3; ++k) {
      if (s->triangle[t].neighbour[k] < t) continue;
      ends[side_count][0] = v[trimesh_next(k)];
      ends[side_count][1] = v[trimesh_previous(k)];
      sides[side_count] = span_of(w, ends[side_count], 2);
      ++side_count;
    }
  }
}

static void look(const fray_world *w, result *r) {
  list_all(w);
  for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t)
    for (uint32_t p = 0; p < w->p.count; ++p) {
      if (are_apart(&points[p], &faces[t])) continue;
      const index_t *v = w->trimesh.triangle[t].v;
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
  result r = {0};
  trimesh_check k;
  const fray_work most = fray_work_bound(f->w);
  trimesh_check_open(&k, f->w);
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    const uint32_t before = f->w->p.count;
    keep_begin(f->w);
    r.last = fixture_tick(f, &fixture_idle);
    r.faults |= r.last.faults;
    r.stops += r.last.work.self_merged;
    r.pairs += r.last.work.self_pairs;
    CHECK(fixture_within_bound(&r.last.work, &most));
    trimesh_check_sums(f->w, &k.area, k.momentum); /* forces change it */
    trimesh_check_now(&k, f->w);
    /* vertices that are born in a tick begin where they are put, which only the stage knows */
    for (uint32_t p = before; p < f->w->p.count && f->w->self.constants != NULL; ++p) began[p] = f->w->self.paths[p].begin;
    if (tick % every == 0 && (before == f->w->p.count || f->w->self.constants != NULL)) look(f->w, &r);
  }
  r.cuts = r.last.tears_total;
  CHECK_EQ_INT(k.bad, 0);
  printf("figure layers_%s %u ways beside each other, %u touch, %u pairs found, %u vertices moved as one, %u cuts, "
         "faults 0x%02X\n", name, r.near, r.passed, r.pairs, r.stops, r.cuts, r.faults);
  return r;
}

/* It falls on its edge and folds; on the ground; on a box. */
static const char folded[] =
    "scene folded\nrate 1000 Hz\nwind 0 0 1 m/s\n%s\n"
    "membrane {\n columns 10\n rows 12\n cell 1 cm\n pattern irregular 3\n material t-shirt\n drag 0.5 /s\n"
    " thickness 0.05 cm\n %s\n}\n"
    "plane ground { at 0 -6.5 0 cm friction 0.5 }\n";
static const char boxed[] =
    "scene boxed\nrate 1000 Hz\nsubsteps 4\n%s\n"
    "membrane {\n columns 10\n rows 14\n cell 1 cm\n pattern irregular 3\n material cotton\n drag 1 /s\n elastic_steps_max 32\n"
    " at 0.4 9 -0.7 cm\n thickness 0.08 cm\n %s\n}\n"
    "material cotton { base t-shirt stretch all 120 20 100 40 N/m }\n"
    "mesh crate { obj \"tests/scenes/meshes/box.obj\" unit 2.5 cm at 0 0 0 cm rotate 20 deg about y friction 0.8 }\n"
    "plane ground { at 0 -2 0 cm }\n";
/* A strip falls in folds on itself between two smooth walls, and comes to rest. */
static const char heap[] =
    "scene heap\nrate 1000 Hz\nsubsteps 4\nwind 0.3 0 1 m/s\n%s\n"
    "membrane {\n columns 5\n rows 30\n cell 1 cm\n pattern irregular 3\n material t-shirt\n drag 2 /s\n elastic_steps_max 32\n"
    " thickness 0.05 cm\n %s\n}\n"
    "box wall { size 40 40 2 cm at 0 -4 2 cm friction 0 }\nbox hind { size 40 40 2 cm at 0 -4 -2.5 cm friction 0 }\n"
    "plane ground { at 0 -16 0 cm friction 0.8 }\n";
static const char slashed[] =
    "scene slashed\nrate 1000 Hz\nsubsteps 2\nwind 0 0 2 m/s\n%s\n"
    "membrane {\n columns 10\n rows 9\n cell 1 cm\n pattern irregular 3\n material rag\n drag 1 /s\n strain_limit 40 %%\n"
    " thickness 0.05 cm\n %s\n}\n"
    "material rag { base t-shirt stretch all 90 15 110 40 N/m tear 8 N/m tear_interval 2 ms cut_speed 0.4 m/s }\n"
    "pin row top\n"
    "mesh blade { obj \"tests/scenes/meshes/sword.obj\" rotate 90 deg about x sharp named friction 0.1\n"
    " move path { 0 s -8 0.6 2 cm  0.01 s -8 0.6 2 cm  0.08 s 8 -0.3 2.2 cm } }\n";
static const char torn[] =
    "scene torn\nrate 1000 Hz\nwind 4 0 2 m/s\n%s\n"
    "membrane {\n columns 12\n rows 9\n cell 2 cm\n pattern irregular 6\n material rag\n drag 0.5 /s\n strain_limit 40 %%\n"
    " thickness 0.05 cm\n %s\n}\n"
    "material rag { base t-shirt tear 4 6 8 6 N/m tear_interval 1 ms }\n"
    "pin column left\npin column right\nsphere iron { radius 1.5 cm at 4 1 -4 cm move free mass 200 g velocity 60 0 200 cm/s }\n";

static void nothing_passes(void) {
  static const struct {
    const char *name, *text;
    uint32_t ticks, passes; /* so many without it, at least */
  } cases[] = {{"folded", folded, 400, 10},
               {"heap", heap, 1200, 10},
               {"boxed", boxed, 600, 10},
               {"torn", torn, 600, 5},
               {"slashed", slashed, 250, 0}};
  for (uint32_t n = 0; n < sizeof cases / sizeof cases[0]; ++n) {
    fixture_scoped f = {0};
    char name[64];
    const uint32_t ticks = cases[n].ticks / (TEST_FEWER == 1 ? 1 : 4);
    open_case(&f, cases[n].text, "limits { contacts 2000 }", "self_collision on");
    result r = run(cases[n].name, &f, ticks, TEST_FEWER);
    CHECK_EQ_INT(r.passed, 0);
    CHECK_EQ_INT(r.faults & (FRAY_FAULT_SELF_COLLISION_BUDGET | FRAY_FAULT_CONTACT_UNRESOLVED), 0);
    fixture_close(&f);
    snprintf(name, sizeof name, "%s_off", cases[n].name);
    open_case(&f, cases[n].text, "limits { contacts 2000 }", "");
    r = run(name, &f, ticks, 2 * TEST_FEWER);
    CHECK(TEST_FEWER != 1 || r.passed >= cases[n].passes);
    CHECK_EQ_INT(r.pairs, 0);
  }
}

#if FRAY_ENERGY
/* What meets loses energy: this stage makes no more than a 200th of what is turned over, in whatever tick. */
static void it_makes_no_energy(void) {
  /* it falls until the edge of the world stops it */
  static const char fallen[] =
      "scene fallen\nrate 240 Hz\nsubsteps 4\n%s\n"
      "membrane {\n columns 10\n rows 5\n cell 0.7247 0.9113 cm\n pattern irregular 223\n material paper\n weft -50.9 deg\n"
      " drag 0 /s\n strain_limit 42 %%\n thickness 0.08304 cm\n elastic_steps_max 39\n self_thickness 0.12429 cm\n %s\n}\n";
  static const struct {
    const char *name, *text;
    uint32_t ticks;
  } cases[] = {{"folded", folded, 400}, {"heap", heap, 1200},      {"boxed", boxed, 600},
               {"torn", torn, 300},     {"slashed", slashed, 250}, {"fallen", fallen, 400}};
  for (uint32_t n = 0; n < sizeof cases / sizeof cases[0]; ++n) {
    fixture_scoped f = {0};
    uint32_t repeats = 0;
    open_case(&f, cases[n].text, "limits { contacts 2000 }", "self_collision on");
    fray_energy_watch(f.w);
    for (uint32_t tick = 0; tick < cases[n].ticks / TEST_FEWER; ++tick) {
      const uint32_t steps = (uint32_t)(f.w->membrane.constants->steps * f.w->params->substeps);
      const uint32_t done = fixture_tick(&f, &fixture_idle).work.particle_steps;
      repeats += done / (steps * (f.w->p.count - particles_attached(f.w))) - 1;
    }
    const fray_energy_account a = fray_energy(f.w);
    double turned = fabs((double)a.gravity) + (double)a.begun;
    for (uint32_t k = 0; k < FRAY_ENERGY_SUPPLIES; ++k) turned += fabs((double)a.supplied[k]);
    const double made = (double)a.made[FRAY_ENERGY_SELF_COLLISION];
    const double lost = (double)a.lost[FRAY_ENERGY_SELF_COLLISION];
    printf("figure layers_%s_made %.3g of what is turned over (asked: at most 0.005), lost %.3g; %u repeats in %u ticks\n",
           cases[n].name, made / turned, lost / turned, repeats, cases[n].ticks / TEST_FEWER);
    CHECK(made <= 0.005 * turned);
  }
}
#endif

/* Too little room: what was not found moves as one, and that is said. */
static void pools_of_any_size(void) {
  static const uint32_t sizes[] = {1, 2, 5, 20, 60};
  for (uint32_t n = 0; n < 2 * sizeof sizes / sizeof sizes[0]; ++n) {
    fixture_scoped f = {0};
    char limits[64];
    char name[64];
    snprintf(limits, sizeof limits, "limits { contacts 2000 self_collision_pairs %u }", sizes[n / 2]);
    snprintf(name, sizeof name, "%s_pairs_%u", n % 2 ? "torn" : "folded", sizes[n / 2]);
    open_case(&f, n % 2 ? torn : folded, limits, "self_collision on");
    const result r = run(name, &f, 400, 2 * TEST_FEWER);
    CHECK_EQ_INT(r.passed, 0);
    CHECK(sizes[n / 2] > 5 || (r.faults & FRAY_FAULT_SELF_COLLISION_BUDGET) != 0);
  }
}

/* What is near each other listed anew in every tick, or kept: the same to the last bit. Visits and sweeps are not
 * the state's; what was found to meet is. */
static void the_list_is_no_state(void) {
  static const char *const texts[] = {folded, heap, torn, slashed};
  static const char *const limits[] = {"limits { contacts 2000 }", "limits { contacts 2000 self_collision_pairs 90 }"};
  for (uint32_t n = 0; n < 8; ++n) {
    fixture_scoped kept = {0};
    fixture_scoped anew = {0};
    uint32_t visits[2] = {0, 0};
    uint32_t met = 0;
    uint32_t differ = 0;
    open_case(&kept, texts[n / 2], limits[n % 2], "self_collision on");
    open_case(&anew, texts[n / 2], limits[n % 2], "self_collision on");
    for (uint32_t tick = 0; tick < 700; ++tick) {
      anew.w->tri.list->valid = 0;
      const fray_output a = fixture_tick(&kept, &fixture_idle);
      const fray_output b = fixture_tick(&anew, &fixture_idle);
      differ += a.hash != b.hash || a.work.self_pairs != b.work.self_pairs || a.work.self_merged != b.work.self_merged ||
                a.faults != b.faults;
      met += a.work.self_pairs;
      visits[0] += a.work.self_box_tests;
      visits[1] += b.work.self_box_tests;
    }
    CHECK_EQ_INT(differ, 0);
    CHECK(met > 100);
    printf("figure layers_list_%u %u met, %u visits with a list that is kept, %u without\n", n, met, visits[0], visits[1]);
  }
}

static int is_in_world(const fray_world *w) {
  for (uint32_t p = 0; p < w->p.count; ++p)
    if (abs(w->p.vx[p]) > FX_SPEED_MAX || abs(w->p.vy[p]) > FX_SPEED_MAX || abs(w->p.vz[p]) > FX_SPEED_MAX) return 0;
  return 1;
}

/* The stage by itself, on sheets that nobody holds and whose vertices go anywhere: momentum is the same to the
 * last bit, and nothing passes. */
static void momentum_is_kept(void) {
  uint64_t seed = 11;
  uint32_t pushed = 0;
  uint32_t joined = 0;
  for (uint32_t n = 0; n < 200 / TEST_FEWER; ++n) {
    fixture_scoped f = {0};
    result r = {0};
    uint64_t area;
    int64_t before[3];
    int64_t after[3];
    fixture_print(&f, "scene s\nrate 1000 Hz\nmembrane { columns 5 rows 4 cell 1 cm pattern irregular %u material denim "
                      "thickness 0.05 cm self_collision on }\n", n);
    fray_world *w = f.w;
    const int32_t far = 1 << (17 + n % 6);
    (void)fixture_tick(&f, &fixture_idle); /* vertices get their masses */
    triangle_collision_begin(w);
    keep_begin(w);
    memset(&w->work, 0, sizeof w->work);
    throw_particles(w, far, 16, &seed);
    trimesh_check_sums(w, &area, before);
    triangle_collision_solve(w);
    trimesh_check_sums(w, &area, after);
    CHECK(memcmp(before, after, sizeof before) == 0);
    CHECK(is_in_world(w));
    look(w, &r);
    CHECK_EQ_INT(r.passed, 0);
    pushed += w->work.self_ccd != 0;
    joined += w->work.self_merged != 0;
  }
  printf("figure layers_momentum of %u crumpled sheets %u met themselves, %u were joined\n", 200 / TEST_FEWER, pushed, joined);
  CHECK(pushed > 60 / TEST_FEWER && joined > 20 / TEST_FEWER);
}

static void saved_in_the_middle(void) {
  static const char *const texts[] = {folded, torn, slashed};
  for (uint32_t n = 0; n < 3; ++n) {
    fixture f;
    open_case(&f, texts[n], "limits { contacts 2000 }", "self_collision on");
    saved_on_the_way(&f, 400, 40);
  }
}

static void damaged_sections(void) {
  fixture_scoped f = {0};
  open_case(&f, folded, "", "self_collision on");
  CHECK(damage_each_bit(&f, IMAGE_TRIANGLE_COLLISION, 2) > 16);
}

/* A header that calls for what the image has not, or has what no other section goes with. */
static void headers_that_lie(void) {
  static const struct {
    uint32_t word, value;
    fray_status status;
  } lies[] = {{IMAGE_CAPACITY_WORD + POOL_TRIANGLE_PAIRS, 0, FRAY_BAD_SECTION},
              {IMAGE_CAPACITY_WORD + POOL_TRIANGLE_PAIRS, MAX_TRIANGLE_PAIRS + 1, FRAY_BAD_FIELD},
              {IMAGE_CAPACITY_WORD + POOL_YARN_PAIRS, 5, FRAY_BAD_SECTION},
              {IMAGE_CAPACITY_WORD + POOL_TRIANGLES, 0, FRAY_BAD_SECTION},
              {IMAGE_VERSION_WORD, FRAY_IMAGE_MAJOR << 16 | 1u, FRAY_BAD_VERSION}};
  for (uint32_t n = 0; n < sizeof lies / sizeof lies[0]; ++n) {
    fixture_scoped f = {0};
    fray_world *w;
    fray_error error;
    open_case(&f, folded, "", "self_collision on");
    bytes_store32(f.image + 4 * lies[n].word, lies[n].value);
    CHECK_EQ_INT(damage_open(&f, &w, &error), lies[n].status);
  }
}

/* The heap, for 60 s. */
static void a_minute(void) {
  fixture_scoped f = {0};
  open_case(&f, heap, "limits { contacts 2000 }", "self_collision on");
  const result r = run("minute", &f, 60000, 50);
  CHECK_EQ_INT(r.passed, 0);
  CHECK_EQ_INT(r.faults & FRAY_FAULT_SELF_COLLISION_BUDGET, 0);
}

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "all") == 0) TEST(a_minute);
  TEST(nothing_passes);
#if FRAY_ENERGY
  TEST(it_makes_no_energy);
#endif
  TEST(pools_of_any_size);
  TEST(the_list_is_no_state);
  TEST(momentum_is_kept);
  TEST(saved_in_the_middle);
  TEST(damaged_sections);
  TEST(headers_that_lie);
  return test_end();
}
