/* SPDX-License-Identifier: Apache-2.0 */
/* The membrane's law beyond its threshold, against the formulas of rt/membrane/strain_law.h in double precision: stress
 * is the derivative of the energy, no slope is steeper than what elastic steps bear, below the threshold the bits are
 * those of c G, and a sheet's threshold is where its triangles' slope comes to the bound. */
#include "tests/lib/test.h"

#include "rt/membrane/membrane.h"
#include "rt/membrane/strain_law.h"
#include "tests/lib/energy_account.h"
#include "tests/lib/world_fixture.h"

enum { SAMPLES = 1000000 / TEST_FEWER, SLOPES = 100000 / TEST_FEWER };
static const double bound = 3.4;

static uint64_t seed = 11;
static double between(double from, double to) {
  return from + (to - from) * (double)(splitmix64(&seed) >> 11) * 0x1p-53;
}

typedef struct {
  double c[4], g0;
  double F[6]; /* U, then V */
} sample;

/* Measured, isotropic, any: c12 up to 0.9 of the root of c11 c22. */
static void draw_stiffness(double c[4]) {
  static const double measured[][4] = {{226, 62, 1059, 84}, {205, 10, 1014, 53}, {46, 53.7, 261, 0.7},
                                       {139, 73.6, 413, 6.4}, {16.6, 0, 34.5, 36.9}, {2110, 72, 2124, 41},
                                       {40.4, 23, 170, 2.7}, {48, 6.8, 104, 60.8}};
  const uint32_t kind = (uint32_t)(splitmix64(&seed) % 3);
  if (kind == 0) {
    memcpy(c, measured[splitmix64(&seed) % 8], 4 * sizeof *c);
  } else if (kind == 1) {
    const double nu = between(0, 0.49);
    c[0] = c[2] = 1 / (1 - nu * nu);
    c[1] = nu * c[0];
    c[3] = c[0] * (1 - nu) / 2;
  } else {
    c[0] = 1;
    c[2] = pow(10, between(-1, 1));
    c[1] = between(0, 0.9) * sqrt(c[0] * c[2]);
    c[3] = between(0, 0.5) * fmax(c[0], c[2]);
  }
}

static double mode_of(const double c[4]) {
  return fmax((c[0] + c[2]) / 2 + hypot((c[0] - c[2]) / 2, c[1]), 2 * c[3]);
}

/* Stretches up to `most`, crushed to 1/100, at any angle, turned in space. */
static sample draw_sample(double most) {
  sample s;
  draw_stiffness(s.c);
  s.g0 = between(0, 1) < 0.4 ? between(0, 0.1) : between(0, 1.5);
  const double l1 = 0.5 * pow(2 * most, between(0, 1));
  const double l2 = between(0, 1) < 0.5 ? pow(10, between(-2, 0.3)) : 0.5 * pow(2 * most, between(0, 1));
  const double a = between(0, 6.3), tilt = between(0, 6.3);
  const double V[2] = {l1 * sin(a), l2 * cos(a)}, U[2] = {l1 * cos(a), -l2 * sin(a)};
  const double F[6] = {U[0], U[1] * cos(tilt), U[1] * sin(tilt), V[0], V[1] * cos(tilt), V[1] * sin(tilt)};
  memcpy(s.F, F, sizeof F);
  return s;
}

typedef struct {
  double g1, g2, cosine, sine;
} principal;

static void strain_of(const double F[6], double g[3]) {
  g[0] = (F[0] * F[0] + F[1] * F[1] + F[2] * F[2] - 1) / 2;
  g[1] = (F[3] * F[3] + F[4] * F[4] + F[5] * F[5] - 1) / 2;
  g[2] = F[0] * F[3] + F[1] * F[4] + F[2] * F[5];
}

static double counted(double g, double g0) {
  const double s0 = sqrt(1 + 2 * g0), x = sqrt(fmax(0, 1 + 2 * g)) - s0;
  return g <= g0 ? g : g0 + s0 * x * 2 / (2 + x);
}
static double counted_slope(double g, double g0) {
  const double s0 = sqrt(1 + 2 * g0), l = sqrt(fmax(0, 1 + 2 * g)), r = 2 / (2 + l - s0);
  return g <= g0 ? 1 : s0 * r * r / l;
}

/* Energy; and stress in the axes of the cloth. */
static double law(const sample *s, const double F[6], double S[3]) {
  double g[3];
  strain_of(F, g);
  const double x = (g[0] - g[1]) / 2, y = g[2] / 2, d = hypot(x, y);
  const double g1 = (g[0] + g[1]) / 2 + d, g2 = (g[0] + g[1]) / 2 - d;
  const double cosine = d > 1e-12 ? x / d : 1, sine = d > 1e-12 ? y / d : 0;
  const double f1 = counted(g1, s->g0), f2 = counted(g2, s->g0);
  const double shear = d > 1e-9 ? (f1 - f2) / (2 * d) : counted_slope(g1, s->g0);
  const double m[3] = {(f1 + f2 + (f1 - f2) * cosine) / 2, (f1 + f2 - (f1 - f2) * cosine) / 2, (f1 - f2) * sine};
  const double T[3] = {s->c[0] * m[0] + s->c[1] * m[1], s->c[1] * m[0] + s->c[2] * m[1], s->c[3] * m[2]};
  const double middle = (T[0] + T[1]) / 2, half = (T[0] - T[1]) / 2;
  const double along = half * cosine + T[2] * sine, across = T[2] * cosine - half * sine;
  const double s1 = counted_slope(g1, s->g0) * (middle + along), s2 = counted_slope(g2, s->g0) * (middle - along);
  const double s12 = shear * across, difference = (s1 - s2) / 2 * cosine - s12 * sine;
  S[0] = (s1 + s2) / 2 + difference;
  S[1] = (s1 + s2) / 2 - difference;
  S[2] = (s1 - s2) / 2 * sine + s12 * cosine;
  return (T[0] * m[0] + T[1] * m[1] + T[2] * m[2]) / 2;
}

static double force(const sample *s, const double F[6], double P[6]) {
  double S[3];
  const double energy = law(s, F, S);
  for (uint32_t n = 0; n < 3; ++n) {
    P[n] = S[0] * F[n] + S[2] * F[3 + n];
    P[3 + n] = S[2] * F[n] + S[1] * F[3 + n];
  }
  return energy;
}

static void stress_is_the_derivative(void) {
  double worst = 0;
  for (uint32_t n = 0; n < SAMPLES; ++n) {
    const sample s = draw_sample(3);
    double P[6], other[6];
    (void)force(&s, s.F, P);
    const uint32_t k = (uint32_t)(splitmix64(&seed) % 6);
    double F[6];
    memcpy(F, s.F, sizeof F);
    F[k] += 1e-7;
    const double up = force(&s, F, other);
    F[k] -= 2e-7;
    worst = fmax(worst, fabs((up - force(&s, F, other)) / 2e-7 - P[k]) / mode_of(s.c));
  }
  figure("strain_law_derivative_off", worst, "of c", "at most 1e-6");
  CHECK(worst <= 1e-6);
}

/* The greatest eigenvalue, by Jacobi's rotations. */
static double steepest(double H[6][6]) {
  double most = -1e300;
  for (uint32_t sweep = 0; sweep < 12; ++sweep)
    for (uint32_t p = 0; p < 6; ++p)
      for (uint32_t q = p + 1; q < 6; ++q) {
        if (fabs(H[p][q]) < 1e-13) continue;
        const double theta = (H[q][q] - H[p][p]) / (2 * H[p][q]);
        const double t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1));
        const double c = 1 / sqrt(t * t + 1), e = t * c;
        for (uint32_t k = 0; k < 6; ++k) {
          const double a = H[k][p], b = H[k][q];
          H[k][p] = c * a - e * b;
          H[k][q] = e * a + c * b;
        }
        for (uint32_t k = 0; k < 6; ++k) {
          const double a = H[p][k], b = H[q][k];
          H[p][k] = c * a - e * b;
          H[q][k] = e * a + c * b;
        }
      }
  for (uint32_t k = 0; k < 6; ++k) most = fmax(most, H[k][k]);
  return most;
}

/* Of corners that move by 1: norm2 is in w^2 h^2 at rest, which g0 brings to the bound. Strains clamp at 4. */
static void no_slope_is_too_steep(void) {
  double worst = 0;
  for (uint32_t n = 0; n < SLOPES; ++n) {
    const sample s = draw_sample(3);
    double H[6][6], up[6], down[6], F[6];
    for (uint32_t k = 0; k < 6; ++k) {
      memcpy(F, s.F, sizeof F);
      F[k] += 1e-6;
      (void)force(&s, F, up);
      F[k] -= 2e-6;
      (void)force(&s, F, down);
      for (uint32_t m = 0; m < 6; ++m) H[m][k] = (up[m] - down[m]) / 2e-6;
    }
    for (uint32_t k = 0; k < 6; ++k)
      for (uint32_t m = 0; m < k; ++m) H[k][m] = H[m][k] = (H[k][m] + H[m][k]) / 2;
    const double at_rest = bound / (1 + 3 * s.g0); /* w^2 h^2 */
    worst = fmax(worst, steepest(H) / mode_of(s.c) * at_rest);
  }
  figure("strain_law_steepest", worst, "of 4, which steps bear", "at most 3.95");
  CHECK(worst <= 3.95);
}

static int32_t q28(double v) { return (int32_t)lrint(fmax(fmin(v, 4), -4) * STRAIN_ONE); }

static void fixed_point_is_the_law(void) {
  double worst = 0, worst_energy = 0;
  uint32_t applied = 0, plain = 0, different = 0;
  for (uint32_t n = 0; n < SAMPLES; ++n) {
    sample s = draw_sample(2.9);
    double g[3], S[3];
    int32_t c[4];
    const double unit = 0x1p29 / (mode_of(s.c) * 3);
    for (uint32_t k = 0; k < 4; ++k) {
      c[k] = (int32_t)lrint(s.c[k] * unit);
      s.c[k] = c[k];
    }
    strain_of(s.F, g);
    if (fmax(g[0], fmax(g[1], fabs(g[2]))) > 4) continue; /* clamped */
    const material_tensor G = {q28(g[0]), q28(g[1]), q28(g[2])};
    const int32_t threshold = q28(s.g0);
    material_tensor m;
    const material_tensor own = strain_law_stress(c, G, threshold, &m);
    const material_tensor today = material_stress(c, G);
    const double largest = (g[0] + g[1]) / 2 + hypot((g[0] - g[1]) / 2, g[2] / 2);
    if (largest > s.g0 && !strain_law_may_apply(G, threshold)) CHECK(largest < s.g0 + 1e-7);
    if (largest < s.g0 - 1e-7) {
      ++plain;
      different += own.uu != today.uu || own.vv != today.vv || own.uv != today.uv;
      continue;
    }
    ++applied;
    const double energy = law(&s, s.F, S);
    const double off = fmax(fmax(fabs(own.uu - S[0]), fabs(own.vv - S[1])), fabs(own.uv - S[2]));
    const material_tensor t = material_stress(c, m);
    const double stored = ((double)t.uu * m.uu + (double)t.vv * m.vv + (double)t.uv * m.uv) * 0x1p-29;
    worst = fmax(worst, off / mode_of(s.c));
    worst_energy = fmax(worst_energy, fabs(stored - energy) / mode_of(s.c));
  }
  figure("strain_law_fixed_point_off", worst, "of c", "at most 2^-23");
  figure("strain_law_energy_off", worst_energy, "of c", "at most 2^-23");
  CHECK(worst <= 0x1p-23);
  CHECK(worst_energy <= 0x1p-23);
  CHECK(applied > SAMPLES / 4 && plain > SAMPLES / 8);
  CHECK_EQ_INT(different, 0);
}

/* With the runtime's own gains: w^2 h^2 at rest, times 1 + 3 g0. */
static void thresholds_are_where_slopes_come_to_the_bound(void) {
  static const char *const materials[] = {"denim", "t-shirt", "pants", "swimsuit", "paper"};
  double low = 1e300, high = 0;
  for (uint32_t n = 0; n < 5; ++n) {
    fixture_scoped f = {0};
    fixture_print(&f, "scene s\nrate 1000 Hz\nsubsteps 2\nmembrane {\n columns 5\n rows 4\n cell 1 cm\n pattern irregular 3\n"
                      " material m\n}\nmaterial m {\n base %s\n tear 50 N/m\n}\n", materials[n]);
    fray_world *w = f.w;
    membrane_stress_update(w);
    membrane_gains_update(w);
    for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t) {
      const int32_t *gain = w->membrane.gains[t].c;
      const double c[4] = {gain[0], gain[1], gain[2], gain[3]};
      const trimesh_weights *r = &w->trimesh.weights[t];
      const double u0 = r->u1 + (double)r->u2, v0 = r->v1 + (double)r->v2;
      const double uu = (double)r->u1 * r->u1 + (double)r->u2 * r->u2 + u0 * u0;
      const double vv = (double)r->v1 * r->v1 + (double)r->v2 * r->v2 + v0 * v0;
      const double uv = (double)r->u1 * r->v1 + (double)r->u2 * r->v2 + u0 * v0;
      const double norm2 = ((uu + vv) / 2 + hypot((uu - vv) / 2, uv)) * 0x1p-44;
      const double share = (double)w->trimesh.area[t] / w->membrane.constants->mass_unit;
      const double at_rest = mode_of(c) * 0x1p-30 * norm2 / share / w->membrane.constants->steps;
      if (w->membrane.strain_threshold[t] == STRAIN_LAW_MAX) {
        CHECK(at_rest < bound / 10 + 1e-3);
        continue;
      }
      const double reached = at_rest * (1 + 3.0 * w->membrane.strain_threshold[t] * 0x1p-28);
      low = fmin(low, reached);
      high = fmax(high, reached);
    }
  }
  printf("figure strain_law_threshold %.5f to %.5f (asked: 3.4 to 1e-3)\n", low, high);
  CHECK(low > bound - 1e-3 && high < bound + 1e-3);
}

/* Bending is not of this law. */
static void what_is_torn_gains_nothing(void) {
  const double most = energy_of_dragged_sheet(" base denim\n bend all 0 uNm\n tear 20 N/m\n");
  figure("strain_law_torn_sheet", most, "of what it was supplied with", "at most 1.25");
  CHECK(most <= 1.25);
}

/* Cloth that neither tears nor has a limit has steps for its loads: the law begins beyond what they draw it to, with
 * c33 of shear as the softest. */
static void loads_do_not_reach_the_law(void) {
  static const double loads[] = {2, 20, 60};
  for (uint32_t n = 0; n < 3; ++n) {
    fixture_scoped f = {0};
    const double softest = 200, strain = loads[n] / softest;
    double least = 1e300;
    fixture_print(&f, "scene s\nrate 1000 Hz\nmembrane {\n columns 3\n rows 3\n cell 1 cm\n material m\n}\nmaterial m {\n base denim\n"
                      " stretch all 600 0 600 100 N/m\n}\npin row top\nload bottom 0 -%g 0 N/m\n", loads[n]);
    membrane_stress_update(f.w);
    membrane_gains_update(f.w);
    for (uint32_t t = 0; t < (uint32_t)f.w->trimesh.state->triangles; ++t)
      least = fmin(least, f.w->membrane.strain_threshold[t] * 0x1p-28);
    printf("figure strain_law_loaded_%g %.4f, %d steps (asked: above %.4f)\n", loads[n], least, f.w->membrane.constants->steps,
           strain);
    CHECK(least > strain);
  }
}

int main(void) {
  TEST(what_is_torn_gains_nothing);
  TEST(loads_do_not_reach_the_law);
  TEST(stress_is_the_derivative);
  TEST(no_slope_is_too_steep);
  TEST(fixed_point_is_the_law);
  TEST(thresholds_are_where_slopes_come_to_the_bound);
  return test_end();
}
