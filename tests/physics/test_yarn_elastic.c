/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns with a stiffness in newtons (woven/yarn_stretch.c) against what the scene says of them: the
 * force at which a single yarn and a uniformly pulled sheet break, over the substeps; the tension
 * along a hanging yarn; the tension while crossings split; momentum and energy. And the same table
 * for projection, whose force is the solver's.
 *
 * The scene language has sheets only: a single yarn is one of two warps that are pulled alike. The
 * wefts between them stay at their rest length and carry nothing, so each bears half of the force.
 */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"
#include "tests/lib/yarn_check.h"

#include "rt/woven/woven.h"

static const uint32_t substeps_tried[] = {2, 4, 8, 16, 32};
enum { TRIED = sizeof substeps_tried / sizeof substeps_tried[0] };

#define STIFFNESS_N 0.5
#define TEAR 0.05

/* Newtons that the cloth pulls at a body with, along an axis, in the last tick. */
static double force_on(const fixture *f, uint32_t b, uint32_t axis) {
  const double speed = (double)fray_view_body(f->w, b).impulse[axis] * fixture_speed(f);
  return -speed * fixture_mass_g(f) * f->facts.rate_hz * 1e-5;
}

/* What links pull with, from their length. */
static double tension(const fixture *f, uint32_t row) {
  const double rest = f->w->woven.link_classes[f->w->woven.spring_kind[row] & SPRING_CLASS].rest;
  return f->facts.yarn_stiffness_un * 1e-6 * (fixture_length(f->w, row) / rest - 1);
}

/* Warps from a row of pins to a bar that draws them apart by 12 % in two seconds. */
static void open_pulled(fixture *f, uint32_t warps, uint32_t wefts, uint32_t substeps,
                        const char *more, const char *limits) {
  const double length = (wefts - 1) / 12.0;
  fixture_print(f,
                "scene pulled\nrate 1000 Hz\nsubsteps %u\ngravity 0 0 0 cm/s2\n"
                "woven {\n warps %u\n wefts %u\n spacing 12 /cm\n tear 5 5 %%\n drag 1 /s\n%s}\n"
                "pin row top\ncapsule end {\n radius 0.05 cm\n length %.4f cm\n at 0 %.6f 0 cm\n"
                " attach_within 0.02 cm\n move path {\n 0 s 0 %.6f 0 cm\n 2 s 0 %.6f 0 cm\n }\n}\n%s",
                substeps, warps, wefts, more, warps / 12.0, -length / 2, -length / 2,
                -length / 2 - 0.12 * length, limits);
}

/* Newtons a yarn in the tick before the first cut. */
static double first_break(uint32_t warps, uint32_t wefts, uint32_t substeps, const char *more,
                          double *strain) {
  fixture_scoped f = {0};
  double force = 0;
  open_pulled(&f, warps, wefts, substeps, more, "");
  for (uint32_t tick = 0; tick < 2000; ++tick) {
    const double before = fixture_largest_strain(f.w, NULL);
    const fray_output out = fixture_tick(&f, &fixture_idle);
    if (out.tears_total != 0) {
      *strain = before;
      break;
    }
    force = force_on(&f, 0, 1) / warps;
  }
  return force;
}

static void break_table(const char *what, uint32_t warps, uint32_t wefts) {
  char name[96];
  double least = 1e9;
  double most = 0;
  for (uint32_t n = 0; n < TRIED; ++n) {
    double strain = 0;
    const double force = first_break(warps, wefts, substeps_tried[n], " stretch 0.5 N\n", &strain);
    const double error = 100 * (force / (STIFFNESS_N * TEAR) - 1);
    snprintf(name, sizeof name, "%s_break_%u_substeps", what, substeps_tried[n]);
    figure(name, 1000 * force, "mN_a_yarn", "25 within 1 %");
    snprintf(name, sizeof name, "%s_break_error_%u_substeps", what, substeps_tried[n]);
    figure(name, error, "%", "within 1");
    CHECK(fabs(error) <= 1);
  }
  for (uint32_t n = 0; n < TRIED; ++n) {
    double strain = 0;
    const double force = first_break(warps, wefts, substeps_tried[n], "", &strain);
    snprintf(name, sizeof name, "%s_break_projected_%u_substeps", what, substeps_tried[n]);
    figure(name, 1000 * force, "mN_a_yarn", "printed: the solver's");
    least = fmin(least, force);
    most = fmax(most, force);
  }
  snprintf(name, sizeof name, "%s_break_projected_most_over_least", what);
  figure(name, most / least, "", "printed: far from 1");
  CHECK(most > 2 * least);
}

static void a_single_yarn_breaks_at_the_scenes_force(void) { break_table("yarn", 2, 24); }
static void a_pulled_sheet_breaks_at_the_scenes_force(void) { break_table("sheet", 12, 13); }

/* ---- a hanging yarn ---- */

enum { HANG_WEFTS = 40, HANG_REST = 3000, HANG_MEAN = 1000 };

static void hang(uint32_t substeps) {
  fixture_scoped f = {0};
  double sum[HANG_WEFTS] = {0};
  double worst = 0;
  char name[64];
  fixture_print(
      &f,
      "scene hung\nrate 1000 Hz\nsubsteps %u\nwoven {\n warps 2\n wefts %d\n spacing 12 /cm\n"
      " stretch 0.5 N\n tear off\n drag 20 /s\n}\npin row top\n",
      substeps, HANG_WEFTS);
  for (uint32_t tick = 0; tick < HANG_REST; ++tick) (void)fixture_tick(&f, &fixture_idle);
  for (uint32_t tick = 0; tick < HANG_MEAN; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    for (uint32_t j = 0; j + 1 < HANG_WEFTS; ++j)
      sum[j] += tension(&f, f.w->woven.spring_of[HANG_WEFTS + 2 * j]) / HANG_MEAN;
  }
  for (uint32_t j = 0; j + 1 < HANG_WEFTS; ++j) {
    const double weight = (HANG_WEFTS - 1 - j) * fixture_mass_g(&f) * 981e-5;
    worst = fmax(worst, fabs(sum[j] / weight - 1));
  }
  snprintf(name, sizeof name, "hanging_yarn_tension_error_%u_substeps", substeps);
  figure(name, 100 * worst, "%", "within 1 along its length");
  CHECK(worst <= 0.01);
}

static void a_hanging_yarn_bears_what_hangs_below(void) {
  for (uint32_t n = 0; n < TRIED; ++n) hang(substeps_tried[n]);
}

/* ---- splits ---- */

/* Right at the split: the springs of a crossing before and after it, at any strain that splits. */
static void a_split_keeps_the_tension_of_its_springs(void) {
  fixture_scoped f = {0};
  double worst = 0;
  open_pulled(&f, 12, 13, 8, " stretch 0.5 N\n yarns on\n split_strain 4 4 %\n", "");
  for (uint32_t tick = 0; tick < 2000 && fixture_largest_strain(f.w, NULL) < 0.037; ++tick)
    (void)fixture_tick(&f, &fixture_idle);
  for (uint32_t c = 12; c < 144; ++c) {
    yarn_grid_star star;
    yarn_grid_springs_at(world_yarn_grid(f.w), c, &star);
    double before[YARN_GRID_AT];
    for (uint32_t n = 0; n < star.count; ++n) before[n] = 0;
    for (uint32_t n = 0; n < star.warp_end; ++n)
      if (star.spring[n] < (uint32_t)f.w->params->links)
        before[n] = tension(&f, f.w->woven.spring_of[star.spring[n]]);
    crossing_split(f.w, c, FRAY_LOOSE);
    for (uint32_t n = 0; n < star.warp_end; ++n)
      if (before[n] > 0.01)
        worst = fmax(worst, fabs(tension(&f, f.w->woven.spring_of[star.spring[n]]) / before[n] - 1));
  }
  figure("split_tension_of_its_springs", 100 * worst, "%", "at most 1");
  CHECK(worst <= 0.01);
}

/* Per cent by which the force on the bar changes from tick to tick while a sheet is drawn and all
 * of it splits, so many crossings a tick; *fall: of the force, from the first split to the last. */
static double split_jump(uint32_t substeps, const char *limits, double *fall) {
  fixture_scoped f = {0};
  CLOSED_BY(yarn_check_close) yarn_check k = {0};
  double jump = 0;
  double before = 0;
  double first = 0;
  uint32_t splits = 0;
  open_pulled(&f, 12, 13, substeps, " stretch 0.5 N\n yarns on\n split_strain 4 4 %\n", limits);
  yarn_check_open(&k, &f);
  for (uint32_t tick = 0; tick < 2000 && splits < 132; ++tick) {
    const fray_output out = fixture_tick(&f, &fixture_idle);
    const double force = force_on(&f, 0, 1);
    yarn_check_tick(&k, &f);
    if (splits > 0) jump = fmax(jump, 100 * fabs(force / before - 1));
    if (splits == 0) first = force;
    splits += out.work.splits;
    before = force;
    if (out.tears_total != 0) break;
  }
  *fall = 100 * (1 - before / first);
  CHECK(splits > 100);
  CHECK_EQ_INT(k.bad, 0);
  return jump;
}

/* One crossing a tick: what a split does to the force. All of them at once: the warps straighten
 * and press their waves into the wefts, which nothing draws; that takes some milliseconds. */
static void the_force_does_not_jump_where_crossings_split(void) {
  for (uint32_t n = 0; n < TRIED; ++n) {
    char name[64];
    double fall;
    const double one = split_jump(substeps_tried[n], "limits {\n splits_per_tick 1\n}\n", &fall);
    snprintf(name, sizeof name, "split_force_change_%u_substeps", substeps_tried[n]);
    figure(name, one, "%_in_a_tick", "at most 1");
    CHECK(one <= 1);
    const double many = split_jump(substeps_tried[n], "", &fall);
    snprintf(name, sizeof name, "split_force_change_%u_substeps_32_at_once", substeps_tried[n]);
    figure(name, many, "%_in_a_tick", "printed");
    snprintf(name, sizeof name, "split_force_fall_%u_substeps_32_at_once", substeps_tried[n]);
    figure(name, fall, "%", "printed: warps straighten");
  }
}

/* ---- momentum and energy ---- */

static void momentum_is_kept_to_the_last_bit(void) {
  uint64_t seed = 3;
  uint32_t changed = 0;
  for (uint32_t trial = 0; trial < 40; ++trial) {
    fixture_scoped f = {0};
    int64_t sum[2][3];
    fixture_print(&f,
                  "scene free\nrate 1000 Hz\nsubsteps %u\ngravity 0 0 0 cm/s2\nwoven {\n warps 9\n"
                  " wefts 8\n spacing 12 /cm\n yarns on\n stretch 0.5 N\n}\n",
                  substeps_tried[trial % TRIED]);
    for (uint32_t c = 0; c < 72; ++c)
      if (splitmix64(&seed) % 2 == 0) crossing_split(f.w, c, FRAY_LOOSE);
    for (uint32_t p = 0; p < f.w->p.count; ++p) {
      f.w->p.x[p] += (int32_t)(splitmix64(&seed) % 400001) - 200000;
      f.w->p.y[p] += (int32_t)(splitmix64(&seed) % 400001) - 200000;
      f.w->p.z[p] += (int32_t)(splitmix64(&seed) % 400001) - 200000;
      f.w->p.vx[p] = (int32_t)(splitmix64(&seed) % 400001) - 200000;
    }
    yarn_momentum(f.w, 0, sum[0]);
    const int32_t speed = f.w->p.vy[5];
    yarn_grip_update(f.w);
    yarn_stretch_run(f.w);
    CHECK_EQ_INT(f.w->state->faults, 0);
    yarn_momentum(f.w, 0, sum[1]);
    changed += f.w->p.vy[5] != speed;
    for (uint32_t n = 0; n < 3; ++n) CHECK_EQ_INT(sum[1][n] - sum[0][n], 0);
  }
  CHECK_EQ_INT(changed, 40);
}

/* erg: of motion, and of links that are too long or too short */
static double energy_of(const fixture *f) {
  const fray_world *w = f->w;
  const double lu = fixture_lu_cm(f) * 0x1p-24;
  double sum = 0;
  for (uint32_t p = (uint32_t)w->params->attached; p < w->p.count; ++p) {
    const double s = fixture_speed(f);
    sum +=
        0.5 * fixture_mass_g(f) * s * s *
        ((double)w->p.vx[p] * w->p.vx[p] + (double)w->p.vy[p] * w->p.vy[p] + (double)w->p.vz[p] * w->p.vz[p]);
  }
  for (uint32_t row = 0; row < (uint32_t)w->params->links; ++row) {
    const double rest = fixture_rest(w, row) * lu;
    const double off = fixture_length(w, row) * lu - rest;
    sum += 0.5 *
           (off > 0                       ? f->facts.yarn_stiffness_un * 0.1 / rest
            : f->w->woven.yarn_gains[1].damping != 0 ? 6000
                                          : 6e5) *
           off * off;
  }
  return sum;
}

/* Drawn by 3 % first, so that it is taut; then, held at both ends, thrown sideways in its middle.
 */
static void pluck(const char *damping, const char *label) {
  fixture_scoped f = {0};
  char name[64];
  char more[256];
  snprintf(more, sizeof more, " stretch 0.5 N\n%s bend 0 g/s2\n shear 0 g/s2\n", damping);
  open_pulled(&f, 2, 24, 4, more, "");
  for (uint32_t tick = 0; tick < 500; ++tick) (void)fixture_tick(&f, &fixture_idle);
  fixture_params(&f)->drag = 0;
  ((rigid_body *)(uintptr_t)f.w->rigid.bodies)->motion = FRAY_FIXED;
  (void)fixture_tick(&f, &fixture_idle);
  for (uint32_t c = 20; c < 28; ++c)
    f.w->p.vz[fray_crossing_particle(f.w, c)] = (int32_t)(20 / fixture_speed(&f));
  const double start = energy_of(&f);
  double most = 0;
  for (uint32_t tick = 0; tick < 4000; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    most = fmax(most, energy_of(&f));
  }
  snprintf(name, sizeof name, "plucked_yarn_energy_most%s", label);
  figure(name, 100 * (most / start - 1), "%_above_the_start", "at most 0.1");
  snprintf(name, sizeof name, "plucked_yarn_energy_after_4_s%s", label);
  figure(name, 100 * energy_of(&f) / start, "%_of_the_start", "printed");
  CHECK(most <= start * 1.001);
}

static void a_plucked_yarn_gains_no_energy(void) {
  pluck("", "");
  /* as stiff when it is pressed: see tools/scene_compiler/yarn_elastic.c */
  pluck(" stretch_damping 0 us\n structural 600001 g/s2\n", "_undamped");
}

int main(void) {
  TEST(a_hanging_yarn_bears_what_hangs_below);
  TEST(a_split_keeps_the_tension_of_its_springs);
  TEST(the_force_does_not_jump_where_crossings_split);
  TEST(momentum_is_kept_to_the_last_bit);
  TEST(a_plucked_yarn_gains_no_energy);
  TEST(a_single_yarn_breaks_at_the_scenes_force);
  TEST(a_pulled_sheet_breaks_at_the_scenes_force);
  return test_end();
}
