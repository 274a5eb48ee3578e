/* SPDX-License-Identifier: Apache-2.0 */
/* What a tick counts is what fray_work_bound() said of it before: on every scene that people run, and
 * where everything tears at once. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

enum { TICKS = 40 };

static void run_scene(const char *path) {
  fixture_scoped f = {0};
  uint32_t most_over = 0;
  uint32_t most_contacts = 0;
  fixture_file(&f, path, NULL);
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    const fray_work most = fray_work_bound(f.w);
    const fray_output out = fixture_tick(&f, &fixture_idle);
    CHECK(fixture_within_bound(&out.work, &most));
    /* these do not depend on what happens */
    CHECK_EQ_INT(out.work.particle_steps, most.particle_steps);
    CHECK_EQ_INT(out.work.projections, most.projections);
    CHECK_EQ_INT(out.work.springs, most.springs);
    CHECK_EQ_INT(out.work.broad_phase_tests, most.broad_phase_tests);
    CHECK_EQ_INT(out.work.tear_tests, most.tear_tests);
    CHECK(out.work.tears <= out.work.over_threshold);
    if (out.work.over_threshold > most_over) most_over = out.work.over_threshold;
    if (out.work.contacts > most_contacts) most_contacts = out.work.contacts;
  }
  printf("figure %s over %u, contacts %u in a tick (asked: printed)\n", path, most_over,
         most_contacts);
}

static void scenes_stay_within(void) {
  static const char *const scenes[] = {
      "tests/scenes/small.scene",       "tests/scenes/hanging.scene", "tests/scenes/mirror.scene",
      "tests/scenes/weight.scene",      "tests/scenes/cube.scene",    "tests/scenes/thrown_ball.scene",
      "tests/scenes/bars_apart.scene",  "tests/determinism/torn.scene",     "tests/determinism/bodies.scene"};
  for (size_t n = 0; n < sizeof scenes / sizeof scenes[0]; ++n) run_scene(scenes[n]);
}

/* Vertices that tears have made count too. */
static void membranes_stay_within(void) {
  fixture_scoped f = {0};
  uint32_t cuts = 0;
  fixture_file(&f, "tests/determinism/membrane_tear.scene", NULL);
  for (uint32_t tick = 0; tick < 250; ++tick) {
    const fray_work most = fray_work_bound(f.w);
    const fray_output out = fixture_tick(&f, &fixture_idle);
    CHECK(fixture_within_bound(&out.work, &most));
    cuts = out.tears_total;
  }
  CHECK(cuts > 4);
  CHECK_EQ_INT(f.w->trimesh.state->allocated, 20); /* all that there are */
}

/* A sheet blown up to twenty times its size: every link is over its threshold in the first tick, the
 * cap holds, and the worst is cut first. */
static void everything_tears_at_once(void) {
  fixture_scoped f = {0};
  fixture_file(&f, "tests/scenes/small.scene", NULL);
  for (uint32_t p = 0; p < (uint32_t)f.w->params->particles; ++p) {
    f.w->p.x[p] *= 20;
    f.w->p.y[p] *= 20;
  }
  const fray_work most = fray_work_bound(f.w);
  const fray_output out = fixture_tick(&f, &fixture_idle);
  CHECK(fixture_within_bound(&out.work, &most));
  CHECK(out.work.over_threshold > most.over_threshold / 2u);
  CHECK_EQ_INT(out.work.tears, most.tears);
  CHECK_EQ_INT(out.tears_waiting, out.work.over_threshold - out.work.tears);
  uint32_t worst = 0;
  for (uint32_t n = 1; n < f.w->woven.tear_count; ++n)
    if (f.w->woven.tear_queue[n].excess > f.w->woven.tear_queue[worst].excess) worst = n;
  CHECK_EQ_INT(out.first_tear, f.w->woven.canonical_id[f.w->woven.tear_queue[worst].spring]);
}

int main(void) {
  TEST(scenes_stay_within);
  TEST(membranes_stay_within);
  TEST(everything_tears_at_once);
  return test_end();
}
