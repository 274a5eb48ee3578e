/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns with a stiffness in newtons (stage/stretch.c) against what the scene says of them: the force at
 * which a single yarn and a uniformly pulled sheet break, over the substeps; the tension along a hanging
 * yarn; the tension while crossings split; momentum and energy. And the same table for projection, whose
 * force is the solver's.
 *
 * The scene language has sheets only: a single yarn is one of two warps that are pulled alike. The wefts
 * between them stay at their rest length and carry nothing, so each bears half of the force. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"
#include "tests/lib/yarn_check.h"

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
FIXTURE double tension(const fixture *f, uint32_t row) {
  const double rest = f->w->links[f->w->row_class[row] & ROW_CLASS].rest;
  return f->facts.stretch_un * 1e-6 * (fixture_length(f->w, row) / rest - 1);
}

/* Warps from a row of pins to a bar that draws them apart by 12 % in two seconds. */
static void open_pulled(fixture *f, uint32_t warps, uint32_t wefts, uint32_t substeps,
                        const char *more) {
  const double length = (wefts - 1) / 12.0;
  fixture_print(f,
                "scene pulled\nrate 1000 Hz\nsubsteps %u\ngravity 0 0 0 cm/s2\n"
                "sheet {\n warps %u\n wefts %u\n spacing 12 /cm\n tear 5 5 %%\n drag 1 /s\n%s}\n"
                "pin row top\nbar end {\n radius 0.05 cm\n length %.4f cm\n at 0 %.6f 0 cm\n"
                " grip 0.02 cm\n move path {\n 0 s 0 %.6f 0 cm\n 2 s 0 %.6f 0 cm\n }\n}\n",
                substeps, warps, wefts, more, warps / 12.0, -length / 2, -length / 2,
                -length / 2 - 0.12 * length);
}

/* Newtons a yarn in the tick before the first cut. */
static double first_break(uint32_t warps, uint32_t wefts, uint32_t substeps, const char *more,
                          double *strain) {
  fixture f;
  double force = 0;
  open_pulled(&f, warps, wefts, substeps, more);
  for (uint32_t tick = 0; tick < 2000; ++tick) {
    const double before = fixture_largest_strain(f.w, NULL);
    const fray_output out = fixture_tick(&f, &fixture_idle);
    if (out.cuts_total != 0) {
      *strain = before;
      break;
    }
    force = force_on(&f, 0, 1) / warps;
  }
  fixture_close(&f);
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

int main(void) {
  TEST(a_single_yarn_breaks_at_the_scenes_force);
  TEST(a_pulled_sheet_breaks_at_the_scenes_force);
  return test_end();
}
