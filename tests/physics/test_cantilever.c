/* SPDX-License-Identifier: Apache-2.0 */
/* Bending of membranes: a strip held along two rows of vertices hangs out under its own
 * weight; its end sinks as far as that of an elastica of the measured stiffness, solved by shooting
 * in double. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

enum { COLUMNS = 12, TICKS = 2500, PIECES = 4000 };

/* t'' = -(w / D)(L - s) cos t, t(0) = 0, t'(L) = 0; returns how far the end is below, in units of
 * L. */
static double elastica(double load) {
  double low = 0;
  double high = 4 * load;
  double sunk = 0;
  for (int round = 0; round < 100; ++round) {
    double t = 0;
    double turn = (low + high) / 2;
    const double h = 1.0 / PIECES;
    sunk = 0;
    for (int n = 0; n < PIECES; ++n) {
      const double s = (n + 0.5) * h;
      const double middle = t + turn * h / 2;
      sunk += sin(middle) * h;
      turn -= load * (1 - s) * cos(middle) * h;
      t += turn * h;
    }
    if (turn > 0)
      high = (low + high) / 2;
    else
      low = (low + high) / 2;
  }
  return sunk;
}

typedef struct {
  const char *weft;
  double stiffness_uNm;
  const char *mesh;
  double bound;
  const char *why;
} strip;

static void run(const strip *c) {
  const double gravity = 9.81;
  fixture_scoped f = {0};
  const double density = 0.2;
  fixture_print(
      &f,
      "scene cantilever\nrate 1000 Hz\ngravity 0 %.3f 0 cm/s2\nmembrane {\n columns %d\n rows 4\n"
      " cell 0.5 cm\n pattern %s\n material own\n weft %s deg\n orientation horizontal\n drag 15 /s\n"
      " at 3 0 0 cm\n}\nbox clamp {\n size 1.1 0.4 4 cm\n at 0 0 0 cm\n attach_within 0 cm\n}\n"
      "material own {\n density 200 g/m2\n isotropic 400 N/m 0.3\n bend all %.6f uNm\n}\n"
      "limits { contacts 0 }\n",
      -gravity * 100, COLUMNS, c->mesh, c->weft, c->stiffness_uNm);
  for (int tick = 0; tick < TICKS; ++tick) fixture_tick(&f, &fixture_idle);
  const fray_particles p = fray_view_particles(f.w);
  double end = 0;
  double count = 0;
  double clamped = -1e9;
  for (uint32_t n = 0; n < p.count; ++n) {
    const double u = f.w->trimesh.u[n] / (double)FX_LU * f.facts.lu_um * 1e-6;
    const double v = f.w->trimesh.v[n] / (double)FX_LU * f.facts.lu_um * 1e-6;
    const double s = c->weft[0] == '0' ? u : -v;
    if (n < p.attached && s > clamped) clamped = s;
    if (fabs(s - COLUMNS * 0.005) < 1e-6) {
      end += p.y[n] / (double)FX_LU * f.facts.lu_um * 1e-6;
      count += 1;
    }
  }
  /* the fold at the last held row stands for half a cell on both sides of it, and one side is
   * clamped */
  const double length = COLUMNS * 0.005 - clamped + 0.0025;
  const double load = density * gravity * length * length * length / (c->stiffness_uNm * 1e-6);
  const double expected = elastica(load) * length;
  const double off = -end / count / expected - 1;
  printf("figure cantilever %-11s weft %2s deg load %5.2f: end %.3f mm below, elastica %.3f mm, "
         "%.2f %% (asked: 5)%s\n",
         c->mesh, c->weft, load, -end / count * 1e3, expected * 1e3, 100 * off, c->why);
  CHECK(fabs(off) < c->bound);
}

static void strips_sink_as_theory_says(void) {
  static const strip strips[] = {
      {"0", 40, "regular", 0.05, ""},
      {"90", 40, "regular", 0.05, ""},
      {"0", 150, "regular", 0.05, ""},
      {"0", 15, "regular", 0.05, ""},
      {"0", 40, "irregular 2", 0.05, ""},
      /* k is that of folds along sides of the mesh, of which this one has none; it may not become worse */
      {"0", 40, "rotated 30 deg", 0.27, "; no side lies along the fold"}};
  for (size_t n = 0; n < sizeof strips / sizeof strips[0]; n += TEST_FEWER) run(&strips[n]);
}

int main(void) {
  TEST(strips_sink_as_theory_says);
  return test_end();
}
