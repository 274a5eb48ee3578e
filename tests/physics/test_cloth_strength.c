/* SPDX-License-Identifier: Apache-2.0 */
/* Virtual strength tests of membranes, tests/scenes/strength/cloth_*: force at the first tear over
 * directions, substeps and meshes; where a trouser tear and a tongue tear run. */
#include "tests/lib/test.h"

#include "tests/lib/crack.h"
#include "tools/world/kernel.h"

enum { SMOOTH = 16 /* ticks */ };

/* N, of a body, the way that it goes. */
static double force_on(const fixture *f, uint32_t b) {
  const fray_body drawn = fray_view_body(f->w, b);
  double along = 0, size = 0;
  for (uint32_t n = 0; n < 3; ++n) {
    along += (double)drawn.impulse[n] * drawn.velocity[n];
    size += (double)drawn.velocity[n] * drawn.velocity[n];
  }
  if (size == 0) return 0;
  return along / sqrt(size) * fixture_speed(f) * fixture_mass_g(f) * f->facts.rate_hz * 1e-5;
}

typedef struct {
  double force; /* N, at the first tear: the mean of the ticks before it, carried on to it */
  double longer; /* by so much, of 20 cm */
  uint32_t tick;
  uint32_t inner;
} first_tear;

/* A line through the last ticks: so much force a tick that a mean alone is late by eight of them. */
static double carried_on(const double *force, uint32_t ticks) {
  double sum = 0, slope = 0, square = 0;
  for (uint32_t n = 0; n < SMOOTH; ++n) {
    const double at = n - (SMOOTH - 1) / 2.0;
    sum += force[(ticks - SMOOTH + n) % SMOOTH];
    slope += at * force[(ticks - SMOOTH + n) % SMOOTH];
    square += at * at;
  }
  return sum / SMOOTH + slope / square * (SMOOTH + 1) / 2.0;
}

static first_tear draw(fixture *f) {
  double force[SMOOTH] = {0};
  first_tear t = {0, 0, 0, f->facts.elastic_steps * f->facts.substeps};
  const int32_t from = fray_view_body(f->w, 0).position[1];
  uint32_t faults = 0;
  for (uint32_t tick = 0; tick < 1000; ++tick) {
    const fray_output out = fixture_tick(f, &fixture_idle);
    faults |= out.faults;
    if (out.tears_total != 0) {
      t.force = carried_on(force, tick);
      t.longer = fabs((double)fray_view_body(f->w, 0).position[1] - from) * fixture_lu_cm(f) * 0x1p-24 / 20;
      t.tick = tick;
      break;
    }
    force[tick % SMOOTH] = force_on(f, 0);
  }
  CHECK(t.tick > SMOOTH);
  CHECK_EQ_INT(faults, 0);
  fixture_close(f);
  return t;
}

/* A load on a rest length is F S, with S the stress in the sheet. At 45 degrees the grips turn the stress, and
 * it is printed. */
static void strips_by_direction(void) {
  static const struct {
    const char *path;
    double strength;
  } strips[] = {{"tests/scenes/strength/cloth_warp.scene", 60},
                {"tests/scenes/strength/cloth_weft.scene", 30},
                {"tests/scenes/strength/cloth_45.scene", 50}};
  for (uint32_t n = 0; n < 3; ++n) {
    fixture f;
    fixture_file(&f, strips[n].path, NULL);
    const first_tear t = draw(&f);
    const double expected = strips[n].strength * (1 + t.longer) * 0.05;
    printf("figure %s %.4f N, %.4f by its strength, %.2f %% longer, %u inner steps\n", strips[n].path, t.force,
           expected, 100 * t.longer, t.inner);
    CHECK(n == 2 || fabs(t.force / expected - 1) < 0.01);
  }
}

static void notched_over_substeps(void) {
  static const char *const substeps[] = {"substeps 4", "substeps 7", "substeps 12", "substeps 16"};
  double least = 1e9, most = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    fixture f;
    fixture_file(&f, "tests/scenes/strength/cloth_notched.scene", "substeps 4", substeps[n], NULL);
    const first_tear t = draw(&f);
    printf("figure notched_%s %.4f N at tick %u, %u inner steps\n", substeps[n], t.force, t.tick, t.inner);
    least = fmin(least, t.force);
    most = fmax(most, t.force);
  }
  figure("notched_over_substeps", 100 * (most / least - 1), "%", "1");
  CHECK(most / least - 1 <= 0.01);
}

static void whole_over_meshes(void) {
  static const struct {
    const char *columns, *rows, *edge;
  } sizes[] = {{"columns 2", "rows 8", "cell 2.5 cm"},
               {"columns 4", "rows 16", "cell 1.25 cm"},
               {"columns 8", "rows 32", "cell 0.625 cm"}};
  double least = 1e9, most = 0;
  for (uint32_t n = 0; n < 3; ++n) {
    fixture f;
    fixture_file(&f, "tests/scenes/strength/cloth_warp.scene", "columns 5", sizes[n].columns, "rows 20",
                 sizes[n].rows, "cell 1 cm", sizes[n].edge, NULL);
    const first_tear t = draw(&f);
    printf("figure whole_%s %.4f N at tick %u, %u inner steps\n", sizes[n].edge, t.force, t.tick, t.inner);
    least = fmin(least, t.force);
    most = fmax(most, t.force);
  }
  figure("whole_over_meshes", 100 * (most / least - 1), "%", "5");
  CHECK(most / least - 1 <= 0.05);
}

/* A notched strip of paper, scaled to what so many inner steps bear, drawn by `drawn_cm` in 0.6 s. */
static void open_paper(fixture *f, uint32_t inner_steps, double drawn_cm) {
  char steps[64], path[64];
  snprintf(steps, sizeof steps, "pattern regular\n  elastic_steps_max %u", inner_steps);
  snprintf(path, sizeof path, "0.6 s 0 %.5f 0 cm }", -10 - drawn_cm);
  fixture_file(f, "tests/scenes/strength/cloth_notched.scene", "pattern regular", steps, "base denim", "base paper",
               "tear 30 50 60 50", "tear 200", "strain_limit 30 %", "strain_limit 10 %", "1 s 0 -11.5 0 cm }", path,
               "columns 5", "columns 10", "row 10 0 2", "row 10 0 3", NULL);
  CHECK(kernel_use(f->w, NULL));
}

/* As softer paper is drawn farther, all tear at about 0.4 s. */
static double scaled_force(uint32_t inner_steps, double *share) {
  fixture f;
  open_paper(&f, inner_steps, 0.1);
  *share = 200 / (1e6 * f.facts.stiffness_q30 * 0x1p-30);
  fixture_close(&f);
  open_paper(&f, inner_steps, 8 * *share);
  const first_tear t = draw(&f);
  printf("figure scaled_paper %.4f N, strength over scaled stiffness %.2f %%, tick %u, %u inner steps\n", t.force,
         100 * *share, t.tick, t.inner);
  return t.force;
}

static void scaled_paper_tears_at_its_force(void) {
  static const uint32_t inner_steps[] = {200, 96, 64, 60, 36};
  double share, stiffest = 0, worst = 0;
  for (uint32_t n = 0; n < sizeof inner_steps / sizeof inner_steps[0]; ++n) {
    const double force = scaled_force(inner_steps[n], &share);
    if (n == 0) stiffest = force;
    else if (share <= 0.03) worst = fmax(worst, fabs(force / stiffest - 1));
  }
  figure("scaled_paper_over_exact", 100 * worst, "%", "2, while strength over scaled stiffness is at most 3 %");
  CHECK(worst > 0 && worst <= 0.02);
}

typedef struct {
  double peak, mean; /* N: the mean of the ticks with a tear behind them */
  uint32_t tears;
  crack_map map;
} spring_tear_find;

static void run_tear(const char *path, spring_tear_find *r) {
  fixture_scoped f = {0};
  uint32_t counted = 0, faults = 0;
  memset(r, 0, sizeof *r);
  fixture_file(&f, path, NULL);
  for (uint32_t tick = 0; tick < 1450; ++tick) {
    const fray_output out = fixture_tick(&f, &fixture_idle);
    const double force = force_on(&f, 0);
    r->peak = fmax(r->peak, force);
    faults |= out.faults;
    if (out.tears_total == 0) continue;
    r->mean += force;
    ++counted;
    r->tears = out.tears_total;
  }
  if (counted != 0) r->mean /= counted;
  crack_find(&r->map, &f);
  CHECK_EQ_INT(faults, 0);
  printf("figure %s peak %.4f N, mean %.4f N, %u tears, %.2f cm, %.2f vertical\n", path, r->peak, r->mean, r->tears,
         r->map.length, r->map.share[0]);
  for (uint32_t n = 0; n < r->map.cracks && n < 3; ++n)
    printf("figure %s crack at weft %.2f to %.2f, warp %.2f to %.2f cm\n", path, r->map.crack[n].low[0],
           r->map.crack[n].high[0], r->map.crack[n].low[1], r->map.crack[n].high[1]);
}

/* Every tear begins within a cell of a slit's end at half the height and runs down along the warp, no farther
 * than a cell from the slit's column; one for each slit at least. */
static void check_runs_down(const crack_map *m, const double *columns, uint32_t count) {
  for (uint32_t k = 0; k < count; ++k) {
    uint32_t here = 0;
    for (uint32_t n = 0; n < m->cracks; ++n)
      here += m->crack[n].low[0] >= columns[k] - 1.01 && m->crack[n].high[0] <= columns[k] + 1.01 &&
              m->crack[n].low[1] < 8 && m->crack[n].high[1] > 8.99 && m->crack[n].high[1] < 11.01;
    CHECK(here >= 1);
    CHECK(count != 1 || here == m->cracks);
  }
  CHECK(m->share[0] >= 0.8);
}

static void trouser_and_tongue(void) {
  spring_tear_find trouser, tongue;
  run_tear("tests/scenes/strength/cloth_trouser.scene", &trouser);
  run_tear("tests/scenes/strength/cloth_tongue.scene", &tongue);
  static const double columns[] = {3, 7};
  check_runs_down(&trouser.map, columns, 1);
  check_runs_down(&tongue.map, columns, 2);
  figure("tongue_over_trouser", tongue.mean / trouser.mean, "", "two tears: 1.5 to 2.5");
  CHECK(tongue.mean > 1.5 * trouser.mean && tongue.mean < 2.5 * trouser.mean);
}

int main(void) {
  TEST(strips_by_direction);
  TEST(notched_over_substeps);
  TEST(whole_over_meshes);
  TEST(scaled_paper_tears_at_its_force);
  TEST(trouser_and_tongue);
  return test_end();
}
