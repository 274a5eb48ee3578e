/* SPDX-License-Identifier: Apache-2.0 */
/* Largest strain against counted projections, for what stands and for other ways (methods.h):
 *
 *   fewer [SCENE|mirror [METHOD [SUBSTEPS]]]
 *
 * A line a run: substeps, projections a tick, largest strain at rest and while the load moves, and
 * how far from a held crossing; what the energy gained above its start; the tick of the first cut
 * with tearing on, and how far from a held crossing; and, at rest and moving, the work as a share
 * of what the runtime's own code needs for the same strain, between its own runs: below 1 is a
 * gain. */

#include "platform/linux/cpu.h"
#include "tests/fewer/methods.h"
#include "tests/lib/world_fixture.h"

static const method methods[] = {
    {.name = "stands"},
    {.name = "stride_2", .strides = {2}},
    {.name = "stride_4", .strides = {4}},
    {.name = "stride_8", .strides = {8}},
    {.name = "strides_4_2", .strides = {4, 2}},
    {.name = "strides_8_4_2", .strides = {8, 4, 2}},
    {.name = "stride_8_inwards", .strides = {8}, .inwards = 1},
    {.name = "turn_about", .order = TURN_ABOUT},
    {.name = "there_and_back", .order = THERE_AND_BACK},
    {.name = "tether_1", .tether = 1},
    {.name = "tether_8", .tether = 8},
    {.name = "factor_1.1", .factor = 1.1},
    {.name = "factor_1.5", .factor = 1.5},
    {.name = "chains", .chains = 1, .chain_cost = 4},
    {.name = "quiet_1", .quiet = 1},
};
enum { METHODS = sizeof methods / sizeof methods[0], RUNGS = 3 };

typedef struct {
  const char *name;
  const char *file;
  const char *edits[8];  /* pairs */
  const char *substeps;  /* what the file says of them */
  const char *settle;    /* what it says, or the words to put it behind */
  uint32_t rungs[RUNGS];
  uint32_t from, until;  /* ticks of the moving load */
  int start_gathered;    /* the load that moves is the sheet itself: not settled */
  double hand_mm_s;
  int tears;
} scene_plan;

static const scene_plan scenes[] = {
    {"hanging_80x40", "tests/scenes/hanging.scene", {NULL}, "substeps auto", "settle 0.2 s",
     {3, 4, 8}, 0, 300, 1, 0, 0},
    {"hanging_160x80", "tests/scenes/hanging.scene",
     {"warps 80", "warps 160", "wefts 40", "wefts 80"}, "substeps auto",
     "settle 0.2 s", {6, 8, 12}, 0, 300, 1, 0, 0},
    {"two_hands", "tests/scenes/two_hands.scene", {"tear 5 10 %", "tear off"}, "substeps auto",
     "settle 1 s", {10, 16, 24}, 0, 180, 0, 20, 1},
    {"cube", "tests/scenes/cube.scene", {"tear 5 10 %", "tear off"}, "substeps 16",
     "gravity 0 -981 0 cm/s2", {32, 48, 64}, 0, 150, 1, 0, 1},
    {"corner_load", "tests/scenes/corner_load.scene", {"tear 5 10 %", "tear off"}, "substeps 24",
     "settle 0.5 s", {10, 16, 24}, 100, 185, 0, 0, 1},
};
enum { SCENES = sizeof scenes / sizeof scenes[0], REST_TICKS = 100 };

typedef struct {
  double work, rest, moving, gained;
  uint32_t first_cut, distance; /* tick, and crossings to the nearest held one; 0: none */
  uint32_t strained_at;         /* crossings from the largest moving strain to a held one */
} outcome;

static void open_scene(const scene_plan *s, uint32_t substeps, const char *settle, int tearing,
                       fixture *f) {
  char *text = fixture_read(s->file);
  char edit[96];
  int found = 1;
  for (uint32_t n = 0; !tearing && n < 8 && s->edits[n] != NULL; n += 2)
    text = fixture_replace(text, s->edits[n], s->edits[n + 1], &found);
  snprintf(edit, sizeof edit, "substeps %u", substeps);
  text = fixture_replace(text, s->substeps, edit, &found);
  if (strstr(text, "\nsweeps") == NULL) {
    snprintf(edit, sizeof edit, "substeps %u\nsweeps 1", substeps);
    char head[32];
    snprintf(head, sizeof head, "substeps %u", substeps);
    text = fixture_replace(text, head, edit, &found);
  }
  if (strncmp(s->settle, "settle", 6) == 0)
    snprintf(edit, sizeof edit, "settle %s", settle);
  else
    snprintf(edit, sizeof edit, "settle %s\n%s", settle, s->settle);
  text = fixture_replace(text, s->settle, edit, &found);
  if (!found) fixture_give_up(s->file, s->settle);
  fixture_text(f, text);
  cpu_use_best(f->w);
  free(text);
}

/* Grid steps from a link to the nearest held crossing. */
static uint32_t steps_to_grip(const fray_world *w, uint32_t row) {
  const uint32_t warps = (uint32_t)w->params->warps;
  uint32_t ends[2];
  uint32_t least = UINT32_MAX;
  weave_ends(world_weave(w), w->home[row], &ends[0], &ends[1]);
  for (uint32_t c = 0; c < warps * (uint32_t)w->params->wefts; ++c) {
    if (w->crossing[c] >= (uint32_t)w->params->held) continue;
    for (uint32_t e = 0; e < 2; ++e) {
      const uint32_t away = (uint32_t)abs((int)(c % warps) - (int)(ends[e] % warps)) +
                            (uint32_t)abs((int)(c / warps) - (int)(ends[e] / warps));
      least = away < least ? away : least;
    }
  }
  return least;
}

static fray_input pull_at(const fixture *f, double hand_mm_s, uint32_t tick) {
  const int32_t at = (int32_t)(hand_mm_s * tick / f->facts.rate_hz * 500);
  const int32_t to[FRAY_HANDS][3] = {{-at, 0, 0}, {at, 0, 0}};
  return hand_mm_s > 0 ? fixture_poses(f, to, tick) : fixture_idle;
}

enum { CUT_TICKS = 800 };

/* When and where the sheet first tears. */
static void find_cut(fixture *f, double hand_mm_s, outcome *o) {
  for (uint32_t tick = 0; tick < CUT_TICKS && o->first_cut == 0; ++tick) {
    const fray_input input = pull_at(f, hand_mm_s, tick);
    const fray_output out = fixture_tick(f, &input);
    if (out.cuts_total == 0) continue;
    o->first_cut = tick;
    o->distance = steps_to_grip(f->w, f->w->row_of[out.cut_first]);
  }
}

static double follow(fixture *f, uint32_t from, uint32_t until, double hand_mm_s, outcome *o) {
  double most = 0;
  const double start = fixture_energy(f, 5, 2);
  for (uint32_t tick = 0; tick < until; ++tick) {
    const fray_input input = pull_at(f, hand_mm_s, tick);
    const fray_output out = fixture_tick(f, &input);
    o->work = out.work.projections > o->work ? out.work.projections : o->work;
    if (tick < from) continue;
    uint32_t at = 0;
    const double strain = fixture_largest_strain(f->w, &at);
    if (strain > most) o->strained_at = steps_to_grip(f->w, at);
    most = fmax(most, strain);
    o->gained = fmax(o->gained, fixture_energy(f, 5, 2) - start);
  }
  return 100 * most;
}

static outcome run(const scene_plan *s, const method *m, uint32_t substeps) {
  outcome o = {0, 0, 0, 0, 0, 0, 0};
  fixture f;
  method_use(m);
  open_scene(s, substeps, "0.5 s", 0, &f);
  o.rest = follow(&f, 0, REST_TICKS, 0, &o);
  if (s->start_gathered) {
    fixture_close(&f);
    open_scene(s, substeps, "0 s", 0, &f);
  }
  if (s->hand_mm_s > 0) (void)fixture_start_hands(&f, 48);
  o.gained = 0;
  o.work = 0;
  o.moving = follow(&f, s->from, s->until, s->hand_mm_s, &o);
  fixture_close(&f);
  if (s->tears) {
    open_scene(s, substeps, s->start_gathered ? "0 s" : "0.5 s", 1, &f);
    if (s->hand_mm_s > 0) (void)fixture_start_hands(&f, 48);
    find_cut(&f, s->hand_mm_s, &o);
    fixture_close(&f);
  }
  method_end();
  return o;
}

/* Work of what stands at this strain, on its runs' line in logarithms; the ends are drawn on. 0
 * where its strain does not fall with its work. */
static double work_for(const outcome *base, int moving, double strain) {
  uint32_t n = 0;
  while (n + 2 < RUNGS && strain < (moving ? base[n + 1].moving : base[n + 1].rest)) ++n;
  const double a = log(moving ? base[n].moving : base[n].rest);
  const double b = log(moving ? base[n + 1].moving : base[n + 1].rest);
  if (b > a - 0.1) return 0;
  const double part = (log(strain) - a) / (b - a);
  return exp(log(base[n].work) + part * (log(base[n + 1].work) - log(base[n].work)));
}

static void print_share(const outcome *base, const outcome *o, int moving) {
  const double needed = work_for(base, moving, moving ? o->moving : o->rest);
  if (needed > 0)
    printf(" %.2f", o->work / needed);
  else
    printf(" -");
}

static uint32_t mirror_broken(const fray_world *w) {
  const uint32_t warps = (uint32_t)w->params->warps;
  uint32_t bad = 0;
  for (uint32_t c = 0; c < warps * (uint32_t)w->params->wefts; ++c) {
    const uint32_t a = w->crossing[c];
    const uint32_t b = w->crossing[c - c % warps + warps - 1 - c % warps];
    bad += w->x[a] != -w->x[b] || w->y[a] != w->y[b] || w->z[a] != w->z[b];
  }
  return bad;
}

enum { MIRROR_TICKS = 1500 };

/* Ticks for which a mirrored scene, which tears, stays so to the last bit. */
static void run_mirror(const method *m) {
  fixture f;
  uint32_t tick = 0;
  fray_output out;
  method_use(m);
  fixture_file(&f, "tests/scenes/mirror.scene", "gravity 0",
               "limits {\n cuts_per_tick 64\n}\ngravity 0", NULL);
  do out = fixture_tick(&f, &fixture_idle);
  while (mirror_broken(f.w) == 0 && ++tick < MIRROR_TICKS);
  printf("%-14s %-20s mirrored for %u of %d ticks, %u cuts\n", "mirror", m->name, tick,
         MIRROR_TICKS, out.cuts_total);
  fflush(stdout);
  fixture_close(&f);
  method_end();
}

static void print_run(const scene_plan *s, const method *m, uint32_t substeps, const outcome *o) {
  printf("%-14s %-20s %3u substeps %9.0f projections  rest %6.2f %%", s->name, m->name, substeps,
         o->work, o->rest);
  printf("  moving %6.2f %% at %2u  gained %8.2g erg", o->moving, o->strained_at, o->gained);
  if (s->tears && o->first_cut == 0) printf("  no cut");
  if (s->tears && o->first_cut != 0) printf("  first cut %3u at %2u", o->first_cut, o->distance);
}

static void run_scene(const scene_plan *s, const char *only) {
  outcome base[RUNGS];
  for (uint32_t m = 0; m < METHODS; ++m) {
    if (m != 0 && only != NULL && strcmp(only, methods[m].name) != 0) continue;
    for (uint32_t n = 0; n < RUNGS; ++n) {
      const outcome o = run(s, &methods[m], s->rungs[n]);
      if (m == 0) base[n] = o;
      print_run(s, &methods[m], s->rungs[n], &o);
      if (m != 0) {
        printf("  work");
        print_share(base, &o, 0);
        print_share(base, &o, 1);
      }
      printf("\n");
      fflush(stdout);
    }
  }
}

static void run_once(const scene_plan *s, const char *only, uint32_t substeps) {
  for (uint32_t m = 0; m < METHODS; ++m) {
    if (strcmp(only, methods[m].name) != 0) continue;
    const outcome o = run(s, &methods[m], substeps);
    print_run(s, &methods[m], substeps, &o);
    printf("\n");
  }
}

int main(int argc, char **argv) {
  for (uint32_t m = 0; m < METHODS; ++m)
    if (argc < 2 || (strcmp(argv[1], "mirror") == 0 &&
                     (argc < 3 || strcmp(argv[2], methods[m].name) == 0)))
      run_mirror(&methods[m]);
  for (uint32_t n = 0; n < SCENES; ++n) {
    if (argc > 1 && strcmp(argv[1], scenes[n].name) != 0) continue;
    if (argc > 3)
      run_once(&scenes[n], argv[2], (uint32_t)strtoul(argv[3], NULL, 10));
    else
      run_scene(&scenes[n], argc > 2 ? argv[2] : NULL);
  }
  return 0;
}
