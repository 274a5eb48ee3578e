/* SPDX-License-Identifier: Apache-2.0 */
/* Patch tests of membranes: loads along three sides, the fourth held where the analytic solution
 * has it; the sheet comes to rest, and then stretch, stress and the reaction are those of a uniform
 * strain. Loads of 1, 10, 100 N/m along warp, weft, 45 degrees, both ways and in shear; every material,
 * regular and irregular meshes. Patches that do not reach what is asked are listed with what they do
 * reach, and may not become worse. `all` runs all of them; without it those that are listed and one in 11.
 *
 * Analytic: P n = T with P = F s, s the stress of Green's strain of F by the oracle's table, F found by
 * Newton's method; s at a dead load per rest length is the second Piola-Kirchhoff stress. */
#include <stdlib.h>

#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"
#include "tests/physics/material_reference.h"

enum { COLUMNS = 16, ROWS = 8, TICKS = 1200, RAMP = 300, HELD_TICKS = 10 };
/* lu: cells of 1 cm at 5 cm a lu */
#define WIDTH (COLUMNS * 0.2)
#define HEIGHT (ROWS * 0.2)

typedef struct {
  double a[2][2]; /* columns are U and V in the sheet's plane */
} plane;

/* n x n, n <= 4, for the column behind them, which gets the result. */
static void solve(double m[4][5], int n) {
  for (int c = 0; c < n; ++c) {
    int best = c;
    for (int r = c; r < n; ++r)
      if (fabs(m[r][c]) > fabs(m[best][c])) best = r;
    for (int k = 0; k <= n; ++k) {
      const double t = m[c][k];
      m[c][k] = m[best][k];
      m[best][k] = t;
    }
    for (int r = 0; r < n; ++r)
      if (r != c) {
        const double q = m[r][c] / m[c][c];
        for (int k = c; k <= n; ++k) m[r][k] -= q * m[c][k];
      }
  }
  for (int c = 0; c < n; ++c) m[c][n] /= m[c][c];
}

/* The strain of a second stress: Newton's method from `g` on. */
static void find_strain(const material_table *f, reference_tensor wanted, double g[3]) {
  for (int round = 0; round < 100; ++round) {
    const reference_tensor now = reference_stress(f, (reference_tensor){g[0], g[1], g[2]});
    double m[4][5];
    for (int c = 0; c < 3; ++c) {
      double h[3] = {g[0], g[1], g[2]};
      const double step = 1e-7;
      h[c] += step;
      const reference_tensor s = reference_stress(f, (reference_tensor){h[0], h[1], h[2]});
      m[0][c] = (s.uu - now.uu) / step;
      m[1][c] = (s.vv - now.vv) / step;
      m[2][c] = (s.uv - now.uv) / step;
    }
    m[0][3] = wanted.uu - now.uu;
    m[1][3] = wanted.vv - now.vv;
    m[2][3] = wanted.uv - now.uv;
    solve(m, 3);
    double most = 0;
    for (int c = 0; c < 3; ++c) most = fmax(most, fabs(m[c][3]));
    const double damp = most > 0.05 ? 0.05 / most : 1;
    for (int c = 0; c < 3; ++c) g[c] += damp * m[c][3];
    if (most < 1e-14) break;
  }
}

/* F without turning whose second stress is the wanted one, followed from no load on. */
enum { LOAD_STEPS = 40 };
static int find(const material_table *f, reference_tensor wanted, plane *F) {
  double g[3] = {0, 0, 0};
  for (int k = 1; k <= LOAD_STEPS; ++k) {
    const double share = k / (double)LOAD_STEPS;
    find_strain(f, (reference_tensor){wanted.uu * share, wanted.vv * share, wanted.uv * share}, g);
  }
  /* F = root(1 + 2 G), symmetric */
  const double a = 1 + 2 * g[0];
  const double b = g[2];
  const double c = 1 + 2 * g[1];
  const double determinant = a * c - b * b;
  if (!(determinant > 0) || !(a + c > 0)) return 0;
  const double s = sqrt(determinant);
  const double t = sqrt(a + c + 2 * s);
  F->a[0][0] = (a + s) / t;
  F->a[0][1] = F->a[1][0] = b / t;
  F->a[1][1] = (c + s) / t;
  return 1;
}

typedef enum { ALONG, BOTH, SHEAR } kind;
static const char *const kind_names[] = {"along", "both ways", "shear"};

typedef struct {
  const char *material, *mesh;
  double weft; /* degrees against the load */
  kind what;
  double load; /* N/m */
} patch;

typedef struct {
  plane position;      /* of (s, t) */
  reference_tensor stress; /* N/m, in u and v */
  double traction[4][2]; /* top, bottom, left, right */
  double strain;       /* the largest principal one, as a stretch less 1 */
} solution;

static plane times(plane a, plane b) {
  plane c;
  for (int r = 0; r < 2; ++r)
    for (int k = 0; k < 2; ++k) c.a[r][k] = a.a[r][0] * b.a[0][k] + a.a[r][1] * b.a[1][k];
  return c;
}

/* Along: force per rest width is the load. Both ways and in shear the second stress is. */
static int solve_patch(const material_table *f, const patch *p, double cosine, double sine, solution *out) {
  const plane to_cloth = {{{cosine, sine}, {-sine, cosine}}};
  double size = p->load;
  plane F = {{{1, 0}, {0, 1}}};
  for (int round = 0; round < 100; ++round) {
    const double n[2] = {cosine, -sine};
    out->stress.uu = p->what == ALONG ? size * n[0] * n[0] : p->what == BOTH ? size : 0;
    out->stress.vv = p->what == ALONG ? size * n[1] * n[1] : p->what == BOTH ? size : 0;
    out->stress.uv = p->what == ALONG ? size * n[0] * n[1] : p->what == BOTH ? 0 : size;
    if (!find(f, out->stress, &F)) return 0;
    if (p->what != ALONG) break;
    const double x = F.a[0][0] * n[0] + F.a[0][1] * n[1];
    const double y = F.a[1][0] * n[0] + F.a[1][1] * n[1];
    size = p->load / hypot(x, y);
  }
  const reference_tensor check = reference_stress(
      f, (reference_tensor){(F.a[0][0] * F.a[0][0] + F.a[1][0] * F.a[1][0] - 1) / 2,
                         (F.a[0][1] * F.a[0][1] + F.a[1][1] * F.a[1][1] - 1) / 2,
                         F.a[0][0] * F.a[0][1] + F.a[1][0] * F.a[1][1]});
  if (!(fabs(check.uu - out->stress.uu) + fabs(check.vv - out->stress.vv) + fabs(check.uv - out->stress.uv) <
        1e-6 * p->load))
    return 0;
  plane m = times(F, to_cloth); /* of (s, t); turned so that s stays along x */
  const double length = hypot(m.a[0][0], m.a[1][0]);
  const plane back = {{{m.a[0][0] / length, m.a[1][0] / length}, {-m.a[1][0] / length, m.a[0][0] / length}}};
  out->position = times(back, m);
  const plane S = {{{out->stress.uu, out->stress.uv}, {out->stress.uv, out->stress.vv}}};
  const plane P = times(times(times(back, F), S), to_cloth);
  static const int way[4][2] = {{0, 1}, {0, -1}, {-1, 0}, {1, 0}};
  for (int k = 0; k < 4; ++k)
    for (int r = 0; r < 2; ++r) out->traction[k][r] = P.a[r][0] * way[k][0] + P.a[r][1] * way[k][1];
  const plane *q = &out->position;
  const double xx = q->a[0][0] * q->a[0][0] + q->a[1][0] * q->a[1][0];
  const double yy = q->a[0][1] * q->a[0][1] + q->a[1][1] * q->a[1][1];
  const double xy = q->a[0][0] * q->a[0][1] + q->a[1][0] * q->a[1][1];
  out->strain = sqrt((xx + yy) / 2 + hypot((xx - yy) / 2, xy)) - 1;
  return 1;
}

static void build(fixture *f, const patch *p, const solution *s) {
  static const double none[4][2];
  const double (*t)[2] = s == NULL ? none : s->traction;
  fixture_print(f,
                "scene patch\nrate 1000 Hz\ngravity 0 0 0 cm/s2\nmembrane {\n columns %d\n rows %d\n cell 1 cm\n"
                " pattern %s\n material %s\n weft %g deg\n drag 20 /s\n}\npin column left\n"
                "load right %.9f %.9f 0 N/m\nload top %.9f %.9f 0 N/m\nload bottom %.9f %.9f 0 N/m\n"
                "limits { spare_particles 0 spare_triangles 0 contacts 0 }\n",
                COLUMNS, ROWS, p->mesh, p->material, p->weft, t[3][0], t[3][1], t[0][0], t[0][1], t[1][0],
                t[1][1]);
}

/* Of a vertex in the sheet's own (s, t), lu, from the middle of its left side, which stays where it is. */
static void rest_place(const fray_world *w, uint32_t v, double c, double s, double at[2]) {
  const double u = w->trimesh.u[v] / (double)FX_LU;
  const double q = w->trimesh.v[v] / (double)FX_LU;
  at[0] = u * c - q * s;
  at[1] = u * s + q * c - HEIGHT / 2;
}

static void hold_at_solution(fixture *f, const solution *s, double c, double sine) {
  for (uint32_t p = 0; p < (uint32_t)f->w->params->attached; ++p) {
    double at[2];
    rest_place(f->w, p, c, sine, at);
    f->w->p.x[p] = (int32_t)lrint((s->position.a[0][0] * at[0] + s->position.a[0][1] * at[1] - WIDTH / 2) * FX_LU);
    f->w->p.y[p] = (int32_t)lrint((s->position.a[1][0] * at[0] + s->position.a[1][1] * at[1]) * FX_LU);
    ((int32_t *)(uintptr_t)f->w->p.attach_x)[p] = f->w->p.x[p];
    ((int32_t *)(uintptr_t)f->w->p.attach_y)[p] = f->w->p.y[p];
  }
}

/* All of it where the solution has it, and used to that strain: c goes by what the strain has been. */
static void start_at_solution(fixture *f, const solution *s, double c, double sine) {
  const fray_world *w = f->w;
  const double (*a)[2] = s->position.a;
  const double U[2] = {a[0][0] * c + a[0][1] * sine, a[1][0] * c + a[1][1] * sine};
  const double V[2] = {a[0][1] * c - a[0][0] * sine, a[1][1] * c - a[1][0] * sine};
  const double one = 1 << STRAIN_BITS;
  const material_tensor g = {(int32_t)lrint((U[0] * U[0] + U[1] * U[1] - 1) / 2 * one),
                    (int32_t)lrint((V[0] * V[0] + V[1] * V[1] - 1) / 2 * one),
                    (int32_t)lrint((U[0] * V[0] + U[1] * V[1]) * one)};
  for (uint32_t p = (uint32_t)w->params->attached; p < w->p.count; ++p) {
    double at[2];
    rest_place(w, p, c, sine, at);
    w->p.x[p] = (int32_t)lrint((a[0][0] * at[0] + a[0][1] * at[1] - WIDTH / 2) * FX_LU);
    w->p.y[p] = (int32_t)lrint((a[1][0] * at[0] + a[1][1] * at[1]) * FX_LU);
  }
  for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t)
    for (uint32_t n = 0; n < SMOOTHED_STRAIN_POLES; ++n) w->membrane.stiffness[t].mean[n] = g;
}

typedef struct {
  double stretch, stress, stress_rms, own, reaction, steps;
} result;

static void measure_stress(const fixture *f, const solution *s, result *r) {
  const fray_world *w = f->w;
  const double scale = fmax(fabs(s->stress.uu), fmax(fabs(s->stress.vv), fabs(s->stress.uv)));
  double sum = 0;
  double area = 0;
  for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t) {
    const index_t *v = w->trimesh.triangle[t].v;
    const double u1 = w->trimesh.u[v[1]] - (double)w->trimesh.u[v[0]];
    const double u2 = w->trimesh.u[v[2]] - (double)w->trimesh.u[v[0]];
    const double v1 = w->trimesh.v[v[1]] - (double)w->trimesh.v[v[0]];
    const double v2 = w->trimesh.v[v[2]] - (double)w->trimesh.v[v[0]];
    const double d = u1 * v2 - u2 * v1;
    double U[3];
    double V[3];
    const int32_t *axes[3] = {w->p.x, w->p.y, w->p.z};
    for (int n = 0; n < 3; ++n) {
      const double e1 = axes[n][v[1]] - (double)axes[n][v[0]];
      const double e2 = axes[n][v[2]] - (double)axes[n][v[0]];
      U[n] = (e1 * v2 - e2 * v1) / d;
      V[n] = (e2 * u1 - e1 * u2) / d;
    }
    const reference_tensor g = {(U[0] * U[0] + U[1] * U[1] + U[2] * U[2] - 1) / 2,
                             (V[0] * V[0] + V[1] * V[1] + V[2] * V[2] - 1) / 2,
                             U[0] * V[0] + U[1] * V[1] + U[2] * V[2]};
    const reference_tensor k = reference_stress(&w->membrane.materials[0], g);
    const double off = fmax(fabs(k.uu - s->stress.uu), fmax(fabs(k.vv - s->stress.vv), fabs(k.uv - s->stress.uv)));
    const material_tensor own = w->membrane.stress[t];
    r->own = fmax(r->own, fmax(fabs(own.uu / 4096.0 - k.uu), fabs(own.vv / 4096.0 - k.vv)) / scale);
    r->stress = fmax(r->stress, off / scale);
    sum += off * off / scale / scale * d;
    area += d;
  }
  r->stress_rms = sqrt(sum / area);
}

static void measure_stretch(const fixture *f, const solution *s, double c, double sine, result *r) {
  const fray_world *w = f->w;
  double mean[2] = {0, 0};
  double expected[2] = {0, 0};
  double count = 0;
  for (uint32_t p = (uint32_t)w->params->attached; p < w->p.count; ++p) {
    double at[2];
    rest_place(w, p, c, sine, at);
    if (at[0] < WIDTH - 1e-5) continue;
    mean[0] += w->p.x[p] / (double)FX_LU + WIDTH / 2;
    mean[1] += w->p.y[p] / (double)FX_LU;
    for (int n = 0; n < 2; ++n) expected[n] += s->position.a[n][0] * at[0] + s->position.a[n][1] * at[1];
    count += 1;
  }
  const double off = hypot(mean[0] - expected[0], mean[1] - expected[1]) / count;
  r->stretch = off / (s->strain * WIDTH);
}

/* At once a load would stretch the sheet twice as far as it does at rest. */
static void load_share(fixture *f, const membrane_load full[MEMBRANE_LOADS], int ticks) {
  membrane_load *load = (membrane_load *)(uintptr_t)f->w->membrane.constants->load;
  for (uint32_t n = 0; n < MEMBRANE_LOADS; ++n)
    for (uint32_t a = 0; a < 3; ++a) load[n].force[a] = (int32_t)((int64_t)full[n].force[a] * ticks / RAMP);
}

/* FROM_REST: the load grows from nothing. FROM_SOLUTION: all of it from the beginning, and it stays.
 * HELD: for some ticks, because the solution is not stable and what is below rounding grows. */
typedef enum { FROM_REST, FROM_SOLUTION, HELD } beginning;

static int run_patch(const patch *p, beginning from, result *r) {
  fixture_scoped f = {0};
  solution s = {0};
  const double pi = acos(-1.0);
  const double h = rint(tan(p->weft * pi / 360) * 4096) / 4096;
  const double c = (1 - h * h) / (1 + h * h);
  const double sine = 2 * h / (1 + h * h);
  memset(r, 0, sizeof *r);
  build(&f, p, NULL);
  const int solved = solve_patch(&f.w->membrane.materials[0], p, c, sine, &s);
  fixture_close(&f);
  if (!solved) return 0;
  build(&f, p, &s);
  hold_at_solution(&f, &s, c, sine);
  if (from != FROM_REST) start_at_solution(&f, &s, c, sine);
  double reaction[2] = {0, 0};
  membrane_load full[MEMBRANE_LOADS];
  memcpy(full, f.w->membrane.constants->load, sizeof full);
  const int ticks = from == HELD ? HELD_TICKS : TICKS;
  const int mean_of = from == HELD ? HELD_TICKS : 200;
  for (int tick = 0; tick < ticks; ++tick) {
    load_share(&f, full, from == FROM_REST && tick < RAMP ? tick : RAMP);
    fixture_tick(&f, &fixture_idle);
    for (int n = 0; n < 2 && tick >= ticks - mean_of; ++n)
      reaction[n] += (double)f.w->rigid.motion[0].impulse[n] / mean_of;
  }
  /* m lu h^-1 2^-28 a tick */
  const double unit = f.facts.particle_mass_ng * 1e-12 * f.facts.lu_um * 1e-6 * f.facts.substeps *
                      f.facts.rate_hz * f.facts.rate_hz / (1 << 28);
  const double width = ROWS * 0.01;
  const double wanted[2] = {s.traction[2][0] * width, s.traction[2][1] * width};
  r->reaction = hypot(reaction[0] * unit - wanted[0], reaction[1] * unit - wanted[1]) / hypot(wanted[0], wanted[1]);
  r->steps = f.facts.elastic_steps * f.facts.substeps;
  measure_stress(&f, &s, r);
  measure_stretch(&f, &s, c, sine, r);
  return 1;
}

static const char *const materials[] = {"denim", "t-shirt", "pants", "swimsuit", "paper"};
static const char *const meshes[] = {"regular", "irregular 3"};

/* Shares of 1: stretch, largest stress, its root of mean square, reaction. */
enum { FIGURES = 4 };
static const double asked[FIGURES] = {1e-3, 1e-2, 3e-3, 1e-3};

/* What is not reached, or not from rest, how near it comes, and why. */
typedef struct {
  patch p;
  beginning from;
  double reached[FIGURES];
  const char *why;
} exception;
static const exception exceptions[] = {
    {{"t-shirt", "regular", 0, SHEAR, 10},
     FROM_SOLUTION,
     {1e-3, 1e-2, 3e-3, 1e-3},
     "two states at rest; from no load it goes to another one"},
    {{"pants", "regular", 0, SHEAR, 100},
     HELD,
     {1e-3, 1e-2, 3e-3, 1e-3},
     "the solution is not stable under dead loads; left e-fold in 14 ms"},
    {{"pants", "irregular 3", 0, SHEAR, 100},
     HELD,
     {1e-3, 1e-2, 3e-3, 1e-3},
     "the solution is not stable under dead loads; left e-fold in 14 ms"},
    {{"t-shirt", "irregular 3", 0, SHEAR, 1},
     FROM_REST,
     {1.13e-3, 1e-2, 3e-3, 1e-3},
     "stretch: not explained; the same with positions and impulses exact"},
    {{"paper", "regular", 45, ALONG, 1},
     FROM_REST,
     {1e-3, 1.75e-2, 6.5e-3, 1e-3},
     "stress: impulses round, and the sheet has a stretch of 1e-4"},
    {{"paper", "irregular 3", 45, ALONG, 100},
     FROM_REST,
     {1e-3, 1.5e-2, 3e-3, 1e-3},
     "stress: elastic_steps_max scales paper to 0.002, and one triangle is beyond the g0 of its law"},
    {{"paper", "irregular 3", 0, SHEAR, 100},
     FROM_REST,
     {1e-3, 2.4e-2, 3e-3, 1e-3},
     "stress: elastic_steps_max scales paper to 0.002, and one triangle is beyond the g0 of its law"},
};
enum { EXCEPTIONS = sizeof exceptions / sizeof exceptions[0] };

static const exception *exception_of(const patch *p) {
  for (size_t n = 0; n < EXCEPTIONS; ++n) {
    const patch *e = &exceptions[n].p;
    if (strcmp(e->material, p->material) == 0 && strcmp(e->mesh, p->mesh) == 0 &&
        fabs(e->weft - p->weft) < 1 && e->what == p->what && fabs(e->load - p->load) < 0.5)
      return &exceptions[n];
  }
  return NULL;
}

typedef struct {
  int number, reached, listed, without;
} count;

/* It has no factor in common with the numbers of materials, meshes, cases and loads, so each of them is met. */
enum { ONE_IN = 11 };
static int every = ONE_IN * TEST_FEWER;
static int runs_listed(void) { return every <= ONE_IN; }

static void run_kind(const patch *p, count *all) {
  const exception *e = exception_of(p);
  result r;
  if (all->number++ % every != 0 && (e == NULL || !runs_listed())) return;
  printf("figure patch %-8s %-11s %2g deg %-9s %3g N/m: ", p->material, p->mesh, p->weft, kind_names[p->what],
         p->load);
  if (!run_patch(p, e == NULL ? FROM_REST : e->from, &r)) {
    printf("the model has no solution\n");
    ++all->without;
    CHECK(e == NULL);
    return;
  }
  const double found[FIGURES] = {r.stretch, r.stress, r.stress_rms, r.reaction};
  const double *bound = e == NULL ? asked : e->reached;
  printf("stretch %.4f %% stress %.3f %% (rms %.3f) reaction %.4f %% own %.3f %% %g steps (asked: 0.1, 1, "
         "0.3, 0.1)%s%s\n",
         100 * r.stretch, 100 * r.stress, 100 * r.stress_rms, 100 * r.reaction, 100 * r.own, r.steps,
         e == NULL ? "" : "; ", e == NULL ? "" : e->why);
  for (int n = 0; n < FIGURES; ++n) CHECK(found[n] < bound[n]);
  ++*(e == NULL ? &all->reached : &all->listed);
}

static void patches(void) {
  static const struct {
    double weft;
    kind what;
  } cases[] = {{0, ALONG}, {90, ALONG}, {45, ALONG}, {0, BOTH}, {0, SHEAR}};
  count all = {0, 0, 0, 0};
  for (size_t m = 0; m < 5; ++m)
    for (size_t n = 0; n < 2; ++n)
      for (size_t k = 0; k < 5; ++k)
        for (double load = 1; load < 101; load *= 10) {
          const patch p = {materials[m], meshes[n], cases[k].weft, cases[k].what, load};
          run_kind(&p, &all);
        }
  printf("figure patches, of %d: %d reach what is asked, %d are listed, %d have no solution\n", all.number,
         all.reached, all.listed, all.without);
  if (runs_listed()) CHECK_EQ_INT(all.listed, EXCEPTIONS);
}

int main(int argc, char **argv) {
  (void)argv;
  if (argc > 1) every = 1;
  TEST(patches);
  return test_end();
}
