/* SPDX-License-Identifier: Apache-2.0 */
/* Largest strain against counted projections, for what stands and for other ways (methods.h):
 *
 *   fewer [SCENE [METHOD]]
 *
 * A line a run: substeps, projections a tick, largest strain at rest and while the load moves, and
 * each as the work that what stands needs for the same strain, between its own runs: below 1 is a
 * gain. `grew` is what a sheet that swings without drag gained above its start. */
#include <time.h>

#include "platform/linux/cpu.h"
#include "tests/fewer/methods.h"
#include "tests/lib/world_fixture.h"

static const method methods[] = {
    {.name = "stands"},
    {.name = "stride_2", .strides = {2}},
    {.name = "stride_4", .strides = {4}},
    {.name = "stride_8", .strides = {8}},
    {.name = "strides_4_2", .strides = {4, 2}},
    {.name = "strides_8_4", .strides = {8, 4}},
    {.name = "strides_8_4_2", .strides = {8, 4, 2}},
    {.name = "strides_16_8_4_2", .strides = {16, 8, 4, 2}},
    {.name = "turn_about", .order = TURN_ABOUT},
    {.name = "there_and_back", .order = THERE_AND_BACK},
    {.name = "tether_1", .tether = 1},
    {.name = "tether_4", .tether = 4},
    {.name = "tether_8", .tether = 8},
    {.name = "tether_8_strides_4_2", .tether = 8, .strides = {4, 2}},
    {.name = "factor_1.1", .factor = 1.1},
    {.name = "factor_1.25", .factor = 1.25},
    {.name = "factor_1.5", .factor = 1.5},
    {.name = "chains", .chains = 1, .chain_cost = 4},
    {.name = "quiet_1", .quiet = 1},
};
enum { METHODS = sizeof methods / sizeof methods[0], RUNGS = 4 };

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
} scene_plan;

static const scene_plan scenes[] = {
    {"hanging_80x40", "tests/scenes/hanging.scene", {NULL}, "substeps auto", "settle 0.2 s",
     {2, 3, 4, 8}, 0, 300, 1, 0},
    {"hanging_160x80", "tests/scenes/hanging.scene", {"warps 80", "warps 160", "wefts 40", "wefts 80"},
     "substeps auto", "settle 0.2 s", {3, 4, 6, 12}, 0, 300, 1, 0},
    {"two_hands", "tests/scenes/two_hands.scene", {"tear 5 10 %", "tear off"}, "substeps auto",
     "settle 1 s", {6, 10, 16, 24}, 0, 230, 0, 20},
    {"cube", "tests/scenes/cube.scene", {"tear 5 10 %", "tear off"}, "substeps 16",
     "gravity 0 -981 0 cm/s2", {12, 16, 32, 64}, 0, 150, 1, 0},
    {"corner_load", "tests/scenes/corner_load.scene", {"tear 5 10 %", "tear off"}, "substeps 24",
     "settle 0.5 s", {6, 10, 16, 24}, 200, 260, 0, 0},
};
enum { SCENES = sizeof scenes / sizeof scenes[0], REST_TICKS = 100 };

typedef struct {
  double work, rest, moving, grew;
} outcome;

static void open_scene(const scene_plan *s, uint32_t substeps, const char *settle, fixture *f) {
  char *text = fixture_read(s->file);
  char edit[96];
  int found = 1;
  for (uint32_t n = 0; n < 8 && s->edits[n] != NULL; n += 2)
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

static double follow(fixture *f, uint32_t from, uint32_t until, double hand_mm_s, outcome *o) {
  double most = 0;
  const double start = fixture_energy(f, 5, 2);
  for (uint32_t tick = 0; tick < until; ++tick) {
    const int32_t at = (int32_t)(hand_mm_s * tick / f->facts.rate_hz * 500);
    const int32_t to[FRAY_HANDS][3] = {{-at, 0, 0}, {at, 0, 0}};
    const fray_input input = hand_mm_s > 0 ? fixture_poses(f, to, tick) : fixture_idle;
    const fray_output out = fixture_tick(f, &input);
    o->work = out.work.projections > o->work ? out.work.projections : o->work;
    if (tick >= from) most = fmax(most, fixture_largest_strain(f->w, NULL));
    if (tick >= from) o->grew = fmax(o->grew, fixture_energy(f, 5, 2) - start);
  }
  return 100 * most;
}

static outcome run(const scene_plan *s, const method *m, uint32_t substeps) {
  outcome o = {0, 0, 0, 0};
  fixture f;
  method_use(m);
  open_scene(s, substeps, "0.5 s", &f);
  o.rest = follow(&f, 0, REST_TICKS, 0, &o);
  if (s->start_gathered) {
    fixture_close(&f);
    open_scene(s, substeps, "0 s", &f);
  }
  if (s->hand_mm_s > 0) (void)fixture_start_hands(&f, 48);
  o.grew = 0;
  o.work = 0;
  o.moving = follow(&f, s->from, s->until, s->hand_mm_s, &o);
  fixture_close(&f);
  method_end();
  return o;
}

/* Work of what stands at this strain, on its runs' line in logarithms; the ends are drawn on. */
static double work_for(const outcome *base, int moving, double strain) {
  uint32_t n = 0;
  while (n + 2 < RUNGS && strain < (moving ? base[n + 1].moving : base[n + 1].rest)) ++n;
  const double a = log(moving ? base[n].moving : base[n].rest);
  const double b = log(moving ? base[n + 1].moving : base[n + 1].rest);
  const double part = (log(strain) - a) / (b - a);
  return exp(log(base[n].work) + part * (log(base[n + 1].work) - log(base[n].work)));
}

static void run_scene(const scene_plan *s, const char *only) {
  outcome base[RUNGS];
  for (uint32_t m = 0; m < METHODS; ++m) {
    if (m != 0 && only != NULL && strcmp(only, methods[m].name) != 0) continue;
    for (uint32_t n = 0; n < RUNGS; ++n) {
      const outcome o = run(s, &methods[m], s->rungs[n]);
      if (m == 0) base[n] = o;
      printf("%-14s %-20s %3u substeps %9.0f projections  rest %6.2f %%", s->name, methods[m].name,
             s->rungs[n], o.work, o.rest);
      printf("  moving %6.2f %%  grew %8.2g erg", o.moving, o.grew);
      if (m != 0)
        printf("  work %.2f %.2f", o.work / work_for(base, 0, o.rest),
               o.work / work_for(base, 1, o.moving));
      printf("\n");
      fflush(stdout);
    }
  }
}

int main(int argc, char **argv) {
  for (uint32_t n = 0; n < SCENES; ++n)
    if (argc < 2 || strcmp(argv[1], scenes[n].name) == 0)
      run_scene(&scenes[n], argc > 2 ? argv[2] : NULL);
  return 0;
}
