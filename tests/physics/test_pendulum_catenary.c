/* SPDX-License-Identifier: Apache-2.0 */
/* Two shapes with a known answer: a pendulum's period and a hanging chain's sag. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

#define PI 3.14159265358979323846

/* 2 x 2 crossings held at their top row swing out of their plane: a bifilar pendulum, whose two
 * bobs move alike, so it is one pendulum of the length of a link. Amplitude 0.05: the period of
 * theory is T0 (1 + a^2/16), 0.016 % longer than that of small swings.
 *
 * What it can resolve: in a substep h the link takes back the g h^2 that gravity moved the bob,
 * along its own direction; the part of this across the fall is g h^2 sin(angle), rounded to whole
 * position steps. `levels` is how many steps that is at the full swing. Below half a step nothing
 * drives the bob back, so with few levels the period is that of the rounding, not of the pendulum
 * (a bob that hangs alone is the worst case: in a sheet the yarn carries more than one crossing).
 * A rounding quantiser over a sine of m levels has a gain within about m^-1.5 / 4 of 1, and the
 * period half of this error: 0.5 % asks for m >= 8.5. */
enum { LEVELS_NEEDED = 9 };

typedef struct {
  double error;  /* of the period, relative */
  double kept;   /* the last swing over the first */
  double levels; /* see above */
} swing;

static swing swing_freely(const char *spacing, uint32_t substeps) {
  const double amplitude = 0.05;
  const int swings = 8;
  fixture_scoped f = {0};
  swing s;
  fixture_print(&f,
                "scene pendulum\nrate 1000 Hz\nsubsteps %u\niterations 1\ngravity 0 -981 0 cm/s2\n"
                "woven {\n warps 2\n wefts 2\n spacing %s\n tear off\n drag 0 /s\n}\npin row top\n",
                substeps, spacing);
  fray_world *w = f.w;
  const double length = w->woven.link_classes[1].rest;
  for (uint32_t p = 2; p < 4; ++p) {
    w->p.y[p] = w->p.y[p - 2] - (int32_t)lround(length * cos(amplitude));
    w->p.z[p] = w->p.z[p - 2] + (int32_t)lround(length * sin(amplitude));
  }
  const double theory = 2 * PI * sqrt(length * 0x1p-24 * fixture_lu_cm(&f) / 981) *
                        (1 + amplitude * amplitude / 16);
  double before = w->p.z[2];
  double first = 0;
  double last = 0;
  double largest = 0; /* in the last swing */
  int falls = 0;      /* zero crossings downwards */
  for (uint32_t tick = 1; falls <= swings && tick < 5000; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    const double now = w->p.z[2];
    CHECK_EQ_INT(w->p.z[2], w->p.z[3]);
    if (before > 0 && now <= 0) {
      last = tick - 1 + before / (before - now);
      if (falls == 0) first = last;
      ++falls;
    }
    if (falls == swings && now < 0) largest = fmax(largest, -now);
    before = now;
  }
  CHECK_EQ_INT(falls, swings + 1);
  s.kept = asin(fmin(1, largest / length)) / amplitude;
  s.error = (last - first) / swings / f.facts.rate_hz / theory - 1;
  s.levels = -(w->params->gravity_y + 0.0) / (1 << FX_SUB_BITS) * sin(amplitude);
  return s;
}

static void a_pendulum_keeps_its_period(void) {
  static const char *const spacings[] = {"0.625 mm", "2 mm", "6.2 mm"};
  static const char *const names[] = {"0.625mm", "2mm", "6.2mm"};
  static const uint32_t substeps[] = {2, 4, 8, 24};
  int resolved = 0;
  for (uint32_t n = 0; n < 4; ++n)
    for (uint32_t m = 0; m < 3; ++m) {
      char name[64];
      char asked[96];
      const swing s = swing_freely(spacings[m], substeps[n]);
      const int resolves = s.levels >= LEVELS_NEEDED;
      snprintf(name, sizeof name, "pendulum_period_%s_%u_substeps", names[m], substeps[n]);
      snprintf(asked, sizeof asked, "%s, %.1f levels; kept %.3f of its swing",
               resolves ? "within 0.5" : "printed only", s.levels, s.kept);
      figure(name, 100 * s.error, "%", asked);
      resolved += resolves;
      if (!resolves) continue;
      CHECK(fabs(s.error) <= 0.005);
      CHECK(s.kept <= 1.01);
    }
  CHECK(resolved >= 7);
}

/* Sag of a catenary of this length over this span: length = 2 a sinh(span / 2a). */
static double catenary_sag(double length, double span) {
  double low = span / 1000;
  double high = span * 1000;
  for (int n = 0; n < 200; ++n) {
    const double a = sqrt(low * high);
    if (2 * a * sinh(span / 2 / a) > length)
      low = a;
    else
      high = a;
  }
  return low * (cosh(span / 2 / low) - 1);
}

/* Two yarns side by side, held at both ends, gathered so that they hang through. The sheet lies
 * flat (in x-z), so both are the same chain: no bend, no shear. Sag is measured from the ends to
 * the lowest crossing. The chain of n links is a polygon, which sags less than the curve by a
 * share of about 1/n^2: 0.03 % for 60 links. */
static void a_chain_hangs_as_a_catenary(void) {
  static const int gathers[] = {5, 20, 40};
  for (uint32_t g = 0; g < 3; ++g) {
    fixture_scoped f = {0};
    char name[64];
    fixture_print(&f,
                  "scene chain\nrate 1000 Hz\nsubsteps 16\niterations 1\nsettle 3 s\n"
                  "woven {\n warps 61\n wefts 2\n spacing 0.8 mm\n orientation horizontal\n bend 0 g/s2\n"
                  " shear 0 g/s2\n tear off\n drag 5 /s\n gather %d %% pleats 6\n}\n"
                  "pin column left\npin column right\n",
                  gathers[g]);
    const fray_world *w = f.w;
    double sag = 0;
    double length = 0;
    double drift = 0;
    const uint32_t ticks = 1000;
    for (uint32_t tick = 0; tick < 2000 + ticks; ++tick) {
      (void)fixture_tick(&f, &fixture_idle);
      if (tick < 2000) continue;
      double lowest = 0;
      for (uint32_t i = 0; i < 61; ++i)
        lowest = fmin(lowest, (double)w->p.y[w->woven.crossing_particle[i]] - w->p.y[w->woven.crossing_particle[0]]);
      sag -= lowest / ticks;
      for (uint32_t home = 0; home < 60; ++home)
        length += fixture_length(w, w->woven.spring_of[home]) / ticks;
      for (uint32_t p = (uint32_t)w->params->attached; p < (uint32_t)w->params->particles; ++p)
        drift = fmax(drift, fabs((double)w->p.vy[p]));
    }
    const double span = (double)w->p.x[w->woven.crossing_particle[60]] - w->p.x[w->woven.crossing_particle[0]];
    const double error = 100 * (sag / catenary_sag(length, span) - 1);
    snprintf(name, sizeof name, "chain_gather_%d_sag", gathers[g]);
    figure(name, error, "%", "within 0.5");
    snprintf(name, sizeof name, "chain_gather_%d_stretch", gathers[g]);
    figure(name, 100 * (length / (60.0 * w->woven.link_classes[1].rest) - 1), "%", "printed");
    snprintf(name, sizeof name, "chain_gather_%d_residual_speed", gathers[g]);
    figure(name, drift * fixture_speed(&f), "cm/s", "printed");
    CHECK(fabs(error) <= 0.5);
  }
}

int main(void) {
  TEST(a_pendulum_keeps_its_period);
  TEST(a_chain_hangs_as_a_catenary);
  return test_end();
}
