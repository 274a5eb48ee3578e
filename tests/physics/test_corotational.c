/* SPDX-License-Identifier: Apache-2.0 */
/* The law of isotropic sheets against its formulas in double precision: stress, energy, and what is pressed; stress is the
 * derivative of the energy and no slope is steeper than what elastic steps bear. Sheets that swing in vacuum, and what is torn, gain no
 * energy. `all`: swings for 60 s. */
#include "tests/lib/test.h"

#include "rt/state/corotational.h"
#include "rt/membrane/membrane.h"
#include "tests/lib/energy_account.h"
#include "tests/lib/world_fixture.h"

enum { SAMPLES = 1000000 / TEST_FEWER, SLOPES = 100000 / TEST_FEWER };

static uint64_t seed = 5;
static int seconds = 4;
static double between(double from, double to) {
  return from + (to - from) * (double)(splitmix64(&seed) >> 11) * 0x1p-53;
}

/* Weft and warp as a stretch turned by two angles, and turned in space. */
static void draw(double least, double most, double F[6]) {
  const double l1 = between(least, most), l2 = between(least, most);
  const double a = between(0, 6.3), b = between(0, 6.3), tilt = between(0, 6.3);
  const double R[2][2] = {{cos(a) * l1 * cos(b) + sin(a) * l2 * sin(b), sin(a) * l1 * cos(b) - cos(a) * l2 * sin(b)},
                          {cos(a) * l1 * sin(b) - sin(a) * l2 * cos(b), sin(a) * l1 * sin(b) + cos(a) * l2 * cos(b)}};
  for (int n = 0; n < 2; ++n) {
    F[3 * n] = R[n][0];
    F[3 * n + 1] = R[n][1] * cos(tilt);
    F[3 * n + 2] = R[n][1] * sin(tilt);
  }
}

static double counted(double l) { return l < 0.5 ? l * l - 0.75 : l - 1; }
static double counted_slope(double l) { return l < 0.5 ? 2 * l : 1; }

/* Energy over area, and P = F S, of mu and lambda. */
static double law(const double F[6], double mu, double lambda, double P[6], double S[3]) {
  double g[3] = {0, 0, 0};
  for (int n = 0; n < 3; ++n) {
    g[0] += F[n] * F[n];
    g[1] += F[3 + n] * F[3 + n];
    g[2] += F[n] * F[3 + n];
  }
  const double d = hypot((g[0] - g[1]) / 2, g[2]), middle = (g[0] + g[1]) / 2;
  const double l1 = sqrt(middle + d), l2 = sqrt(fmax(0, middle - d));
  const double cosine = d > 1e-13 ? (g[0] - g[1]) / 2 / d : 1, sine = d > 1e-13 ? g[2] / d : 0;
  const double f1 = counted(l1), f2 = counted(l2);
  const double s1 = (2 * mu * f1 + lambda * (f1 + f2)) * counted_slope(l1) / l1;
  const double s2 = (2 * mu * f2 + lambda * (f1 + f2)) * (l2 < 0.5 ? 2 : 1 / l2);
  S[0] = (s1 + s2) / 2 + (s1 - s2) / 2 * cosine;
  S[1] = (s1 + s2) / 2 - (s1 - s2) / 2 * cosine;
  S[2] = (s1 - s2) / 2 * sine;
  for (int n = 0; n < 3; ++n) {
    P[n] = S[0] * F[n] + S[2] * F[3 + n];
    P[3 + n] = S[2] * F[n] + S[1] * F[3 + n];
  }
  return mu * (f1 * f1 + f2 * f2) + lambda / 2 * (f1 + f2) * (f1 + f2);
}

/* A Poisson's ratio to mu and lambda of a sheet with c11 = 1. */
static double draw_sheet(double *mu, double *lambda) {
  const double nu = between(0, 0.499);
  *lambda = nu;
  *mu = (1 - nu) / 2;
  return nu;
}

static int32_t q28(double v) { return (int32_t)lrint(v * STRAIN_ONE); }

static void compare(double least, double most, double *stress, double *energy) {
  double mu, lambda, P[6], S[3], F[6];
  const double unit = 0x1p28;
  *stress = *energy = 0;
  for (uint32_t n = 0; n < SAMPLES; ++n) {
    draw_sheet(&mu, &lambda);
    draw(least, most, F);
    const int32_t c[4] = {(int32_t)unit, (int32_t)lrint(lambda * unit), (int32_t)unit, (int32_t)lrint(mu * unit)};
    const double uu = F[0] * F[0] + F[1] * F[1] + F[2] * F[2], vv = F[3] * F[3] + F[4] * F[4] + F[5] * F[5];
    const material_tensor g = {q28((uu - 1) / 2), q28((vv - 1) / 2), q28(F[0] * F[3] + F[1] * F[4] + F[2] * F[5])};
    const double stored = law(F, mu, lambda, P, S);
    material_tensor m;
    const material_tensor own = corotational_stress(c, g, &m);
    const material_tensor t = material_stress(c, m);
    const double off = fmax(fmax(fabs(own.uu / unit - S[0]), fabs(own.vv / unit - S[1])), fabs(own.uv / unit - S[2]));
    const double sum = ((double)t.uu * m.uu + (double)t.vv * m.vv + (double)t.uv * m.uv) / unit * 0x1p-29;
    *stress = fmax(*stress, off);
    *energy = fmax(*energy, fabs(sum - stored));
  }
}

static void figure_at_most(const char *name, double value, double most, const char *of) {
  printf("figure %s %.3g %s (asked: at most %.3g)\n", name, value, of, most);
  CHECK(value <= most);
}

static void fixed_point_is_the_law(void) {
  double stress, energy;
  compare(0.6, 1.4, &stress, &energy);
  figure_at_most("corotational_off", stress, 1e-6, "of c");
  figure_at_most("corotational_energy_off", energy, 1e-6, "of c");
  compare(0.0, 1.2, &stress, &energy);
  figure_at_most("corotational_pressed_off", stress, 1e-6, "of c");
  figure_at_most("corotational_pressed_energy_off", energy, 1e-6, "of c");
  compare(0.3, 2.9, &stress, &energy);
  figure_at_most("corotational_drawn_off", stress, 1e-6, "of c");
}

/* A sheet at rest has no stress: not a unit. */
static void at_rest_there_is_none(void) {
  const int32_t c[4] = {1 << 30, 3 << 27, 1 << 30, 5 << 26};
  const material_tensor rest = {0, 0, 0};
  material_tensor m;
  const material_tensor s = corotational_stress(c, rest, &m);
  CHECK(s.uu == 0 && s.vv == 0 && s.uv == 0 && m.uu == 0 && m.vv == 0 && m.uv == 0);
}

/* Of a triangle alone: the greatest eigenvalue of the second derivative, by power steps. */
static void no_slope_is_too_steep(void) {
  double worst = 0, derivative = 0;
  for (uint32_t n = 0; n < SLOPES; ++n) {
    double mu, lambda, F[6], up[6], down[6], S[3], H[6][6], x[6], y[6], size = 0;
    draw_sheet(&mu, &lambda);
    draw(0.02, 3, F); /* beyond it a membrane is overstretched */
    for (uint32_t k = 0; k < 6; ++k) {
      double to[6];
      memcpy(to, F, sizeof to);
      to[k] += 1e-6;
      const double more = law(to, mu, lambda, up, S);
      to[k] -= 2e-6;
      const double less = law(to, mu, lambda, down, S);
      for (uint32_t m = 0; m < 6; ++m) H[m][k] = (up[m] - down[m]) / 2e-6;
      (void)law(F, mu, lambda, up, S);
      derivative = fmax(derivative, fabs((more - less) / 2e-6 - up[k]));
      x[k] = between(-1, 1);
    }
    for (uint32_t k = 0; k < 6; ++k) H[k][k] += 4; /* the greatest, not the farthest from 0 */
    for (uint32_t step = 0; step < 60; ++step) {
      size = 0;
      for (uint32_t m = 0; m < 6; ++m) {
        y[m] = 0;
        for (uint32_t k = 0; k < 6; ++k) y[m] += H[m][k] * x[k];
        size += y[m] * y[m];
      }
      size = sqrt(size);
      for (uint32_t m = 0; m < 6; ++m) x[m] = y[m] / size;
    }
    const double borne = lambda > 0.4 ? 1.21 : 1; /* its steps have that more */
    worst = fmax(worst, (size - 4) / (2 * mu + 2 * lambda) / borne);
  }
  figure_at_most("corotational_derivative_off", derivative, 1e-6, "of c");
  figure_at_most("corotational_steepest", worst, 4 / 3.27, "of that at rest, of which steps bear 3.27 in 4");
}

/* ---- sheets ---- */

static const char sheet[] =
    "scene s\nrate 1000 Hz\ngravity 0 -981 0 cm/s2\nmembrane {\n columns %d\n rows %d\n cell 5 mm\n pattern %s\n material m\n"
    " orientation horizontal\n drag 0 /s\n elastic_steps_max 32\n}\nmaterial m {\n density 200 g/m2\n young %s\n thickness 0.2 mm\n"
    " bend all 60 uNm\n%s}\npin column left\nlimits { contacts 0 }\n";

/* Made less lost, of what gravity gave. */
static void a_swing_gains_nothing(void) {
  static const char *const patterns[] = {"regular", "irregular 3"};
  for (uint32_t n = 0; n < 2; ++n) {
    fixture_scoped f = {0};
    double made = 0, lost = 0, most = 0;
    fixture_print(&f, sheet, 12, 4, patterns[n], n == 0 ? "20 MPa" : "2 MPa", "");
    fray_energy_watch(f.w);
    for (int tick = 0; tick < seconds * 1000; ++tick) {
      (void)fixture_tick(&f, &fixture_idle);
      const fray_energy_account k = fray_energy(f.w);
      double given = 0;
      for (uint32_t stage = 0; stage < FRAY_ENERGY_STAGES; ++stage) given += account_net(&k, stage);
      most = fmax(most, fabs((double)k.gravity));
      made = fmax(made, given);
      lost = fmax(lost, -given);
    }
    printf("figure corotational_swing_%u_made %.3g of what it swings with, lost %.3g, in %d s (asked: at most 1e-4 made)\n",
           (unsigned)n, made / most, lost / most, seconds);
    CHECK(most > 0 && made <= 1e-4 * most);
    CHECK_EQ_INT((long long)(f.w->state->faults), 0);
  }
}

static void stiff_sheets_are_scaled_with_their_strength(void) {
  fixture_scoped f = {0};
  fixture_print(&f, sheet, 6, 4, "regular", "3 GPa", " tear 1000 N/m\n");
  const double scale = f.facts.stiffness_q30 * 0x1p-30;
  CHECK(f.facts.corotational == 1 && scale > 0 && scale < 0.1);
  CHECK(fabs(f.w->membrane.tear_strengths[0].strength[0] / (4096.0 * 1000 * scale) - 1) < 1e-3);
  CHECK(fabs(f.w->membrane.materials[0].stretch[0][0] / (4096 * 6e5 / (1 - 0.09) * scale) - 1) < 1e-4);
  CHECK_EQ_INT(((const uint32_t *)f.image)[1], 3u << 16 | 1u);
}

/* Drawn to 1.4 both ways: E h (l - 1) / (1 - nu). */
static void views_have_stress_by_this_law(void) {
  fixture_scoped f = {0};
  fixture_print(&f, sheet, 4, 4, "regular", "2 MPa", "");
  int32_t *at[3] = {f.w->p.x, f.w->p.y, f.w->p.z};
  for (uint32_t n = 0; n < 3; ++n)
    for (uint32_t p = 0; p < f.w->p.count; ++p) at[n][p] = (int32_t)(at[n][p] * 1.4);
  for (uint32_t t = 0; t < fray_get_info(f.w).triangles; ++t) {
    const fray_triangle v = fray_view_triangle(f.w, t);
    CHECK(fabs(v.stress[0] / (4096 * 400 * 0.4 / 0.7) - 1) < 1e-4);
    CHECK(fabs(v.stress[1] / (4096 * 400 * 0.4 / 0.7) - 1) < 1e-4);
    CHECK(abs(v.stress[2]) < 4);
  }
}

static void what_is_torn_gains_nothing(void) {
  const double most =
      energy_of_dragged_sheet(" density 400 g/m2\n young 2 MPa\n thickness 0.5 mm\n tear 60 N/m\n");
  figure_at_most("corotational_torn_sheet", most, 1.25, "of what it was supplied with");
}

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "all") == 0) seconds = 60;
  TEST(at_rest_there_is_none);
  TEST(fixed_point_is_the_law);
  TEST(no_slope_is_too_steep);
  TEST(stiff_sheets_are_scaled_with_their_strength);
  TEST(views_have_stress_by_this_law);
  TEST(what_is_torn_gains_nothing);
  TEST(a_swing_gains_nothing);
  return test_end();
}
