/* SPDX-License-Identifier: Apache-2.0 */
/* Free fall and flight against the same integrator (symplectic Euler, same h) in double precision
 * with the exact g: what is asked is at most 2 position steps (2^-24 lu) of error per tick.
 *
 * The bound that follows from rt/integrate/particles.c: the velocity is the exact one rounded down to a
 * whole Q28 step (the remainder runs on), so it is off by less than 1 step of 2^-28 lu per substep,
 * and no rounding of positions accumulates. In a tick of n substeps that is less than n/16 position
 * steps: 2 at n = 32. A start velocity from the scene is rounded too: n/32 more. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

enum { TICKS = 320 };
static const uint32_t substeps_tried[] = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32};
enum { TRIED = sizeof substeps_tried / sizeof substeps_tried[0] };

typedef struct {
  double x[3], v[3], a[3]; /* in position steps, per substep */
} flight;

static void fly(flight *f, uint32_t substeps) {
  for (uint32_t s = 0; s < substeps; ++s)
    for (uint32_t n = 0; n < 3; ++n) {
      f->v[n] += f->a[n];
      f->x[n] += f->v[n];
    }
}

static flight start(const fixture *f, const double velocity[3], const int32_t at[3]) {
  const double per_second = (double)f->facts.rate_hz * f->facts.substeps;
  const double steps = 0x1p24 / fixture_lu_cm(f); /* in a cm */
  flight o;
  for (uint32_t n = 0; n < 3; ++n) {
    o.x[n] = at[n];
    o.v[n] = velocity[n] * steps / per_second;
    o.a[n] = n == 1 ? -981.0 * steps / (per_second * per_second) : 0;
  }
  return o;
}

/* A sheet that nothing holds. Its spacing is a whole number of position steps (2^20), so that it
 * starts exactly at rest. `springs`: bend and shear at the paper's constants, or none. */
static double fall(uint32_t substeps, int springs) {
  fixture_scoped f = {0};
  fixture_print(&f,
                "scene fall\nrate 1000 Hz\nsubsteps %u\niterations 1\ngravity 0 -981 0 cm/s2\n"
                "woven {\n warps 5\n wefts 4\n spacing 0.625 mm\n bend %d g/s2\n shear %d g/s2\n"
                " drag 0 /s\n at 0 45 0 cm\n}\n",
                substeps, springs ? 5 : 0, springs ? 2 : 0);
  const double rest[3] = {0, 0, 0};
  flight o[20];
  double most = 0;
  for (uint32_t p = 0; p < 20; ++p) {
    const int32_t at[3] = {f.w->p.x[p], f.w->p.y[p], f.w->p.z[p]};
    o[p] = start(&f, rest, at);
  }
  for (uint32_t tick = 1; tick <= TICKS; ++tick) {
    const fray_output out = fixture_tick(&f, &fixture_idle);
    CHECK_EQ_INT(out.faults, 0);
    for (uint32_t p = 0; p < 20; ++p) {
      fly(&o[p], substeps);
      const double error = fmax(fmax(fabs(f.w->p.x[p] - o[p].x[0]), fabs(f.w->p.y[p] - o[p].x[1])),
                                fabs(f.w->p.z[p] - o[p].x[2]));
      CHECK(error <= substeps / 16.0 * tick + 1);
      if (error / tick > most) most = error / tick;
    }
  }
  return most;
}

static void a_free_sheet_falls_as_in_double(void) {
  for (uint32_t n = 0; n < TRIED; ++n) {
    char name[64];
    const double bare = fall(substeps_tried[n], 0);
    const double sprung = fall(substeps_tried[n], 1);
    snprintf(name, sizeof name, "free_fall_%u_substeps", substeps_tried[n]);
    figure(name, fmax(bare, sprung), "position_steps_per_tick", "at most 2");
    CHECK(bare <= 2);
    CHECK(sprung <= 2);
  }
}

static double throw_ball(uint32_t substeps) {
  fixture_scoped f = {0};
  fixture_print(&f,
                "scene thrown\nrate 1000 Hz\nsubsteps %u\niterations 1\n"
                "woven {\n warps 2\n wefts 2\n spacing 0.625 mm\n drag 0 /s\n"
                " at -50 -50 -50 cm\n}\n"
                "pin row top\nsphere b {\n radius 0.5 cm\n at 0 10 0 cm\n move free\n mass 20 g\n"
                " velocity 31.7 123.45 -77.7 cm/s\n}\n",
                substeps);
  const double velocity[3] = {31.7, 123.45, -77.7};
  double most = 0;
  flight o = start(&f, velocity, f.w->rigid.states[0].position);
  for (uint32_t tick = 1; tick <= TICKS; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    fly(&o, substeps);
    for (uint32_t n = 0; n < 3; ++n) {
      const double error = fabs(f.w->rigid.states[0].position[n] - o.x[n]);
      CHECK(error <= substeps * (1.0 / 16 + 1.0 / 32) * tick + 1);
      if (error / tick > most) most = error / tick;
    }
  }
  return most;
}

static void a_thrown_ball_flies_as_in_double(void) {
  for (uint32_t n = 0; n < TRIED; ++n) {
    char name[64];
    const double error = throw_ball(substeps_tried[n]);
    snprintf(name, sizeof name, "thrown_ball_%u_substeps", substeps_tried[n]);
    figure(name, error, "position_steps_per_tick", "at most 2");
    CHECK(error <= 2);
  }
}

int main(void) {
  TEST(a_free_sheet_falls_as_in_double);
  TEST(a_thrown_ball_flies_as_in_double);
  return test_end();
}
