/* SPDX-License-Identifier: Apache-2.0 */
/* The bound of the elastic steps: no triangle alone vibrates faster than they bear, in any image at rest and after
 * any tear. An explicit step of h is stable while w^2 h^2 is below 4; vertices that triangles share are the sum of
 * their parts, so a bound of each triangle is one of the mesh.
 *
 *   w^2 h^2 = 3 h^2 / density * (greater eigenvalue of the sum of r r') * (stiffest mode of c)
 *
 * in SI, from the scene's own numbers. */
#include "tests/lib/test.h"

#include "rt/membrane/membrane.h"
#include "rt/trimesh/trimesh_split.h"
#include "tests/lib/world_fixture.h"

enum { SCENES = 400 / TEST_FEWER, TEARS = 1000 / TEST_FEWER };
static const double asked = 3.3;

static uint64_t seed = 1;
static uint32_t below(uint32_t n) { return (uint32_t)((splitmix64(&seed) >> 32) * n >> 32); }
/* Evenly by its logarithm, in as many digits as people write. */
static double some(double from, double to) {
  char text[32];
  snprintf(text, sizeof text, "%.2g", from * pow(to / from, below(1000000) / 1e6));
  return strtod(text, NULL);
}

typedef struct {
  double rate, density, cell[2];
  uint32_t columns, rows;
  char text[2048];
} sheet;

static double draw_material(char *text, size_t room) {
  static const char *const measured[] = {"denim", "t-shirt", "pants", "swimsuit"};
  static const double densities[] = {0.324, 0.187, 0.22, 0.204};
  const uint32_t kind = below(3);
  const double density = some(0.002, 0.5);
  if (kind == 0) {
    const uint32_t n = below(4);
    snprintf(text, room, " base %s\n", measured[n]);
    return densities[n];
  }
  if (kind == 1) {
    snprintf(text, room, " density %.9g kg/m2\n isotropic %.9g N/m 0.%02u\n", density, some(0.1, 1e6),
             below(49));
    return density;
  }
  const double c11 = some(1, 1e5);
  const double c22 = c11 * some(0.1, 10);
  snprintf(text, room, " density %.9g kg/m2\n stretch all %.9g %.9g %.9g %.9g N/m\n stretch 45 %.9g 0 %.9g %.9g N/m\n",
           density, c11, 0.9 * fmin(c11, c22) * below(100) / 100, c22, c11 * some(0.01, 2), 2 * c11, c22, c11);
  return density;
}

static void draw_sheet(sheet *s) {
  static const char *const meshes[] = {"regular", "rotated 30 deg", "rotated 17.3 deg", "irregular 3", "irregular 8"};
  static const double rates[] = {240, 500, 600, 1000, 1500, 2000};
  char material[512];
  char tear[64] = "";
  s->rate = rates[below(6)];
  s->columns = 3 + below(6);
  s->rows = 3 + below(6);
  s->cell[0] = some(0.1, 3);
  s->cell[1] = s->cell[0] * (below(2) == 0 ? 1 : some(0.5, 2));
  s->density = draw_material(material, sizeof material);
  if (below(2) == 0) snprintf(tear, sizeof tear, " tear %.9g N/m\n", some(0.1, 1000));
  const uint32_t substeps = 1 + below(6);
  snprintf(s->text, sizeof s->text,
           "scene sheet\nrate %.0f Hz\nsubsteps %u\nmembrane {\n columns %u\n rows %u\n cell %.9g %.9g cm\n"
           " pattern %s\n material cloth\n strain_limit %u %%\n elastic_steps_max %u\n}\n"
           "material cloth {\n%s bend all %.9g uNm\n%s}\npin row top\n",
           s->rate, substeps, s->columns, s->rows, s->cell[0], s->cell[1], meshes[below(5)],
           below(3) == 0 ? 0 : 10 * below(10), 8 + below(500), material, below(3) == 0 ? 0 : some(0.1, 100), tear);
}

/* What its stiffest row resists at most, N/m. */
static double stiffest(const material_table *f) {
  double most = 0;
  for (uint32_t row = 0; row < MATERIAL_ROWS; ++row) {
    const int32_t *c = f->stretch[row];
    const double both = (c[0] + (double)c[2]) / 2 + hypot((c[0] - (double)c[2]) / 2, c[1]);
    most = fmax(most, fmax(both, 2.0 * c[3]) / 4096);
  }
  return most;
}

/* 1 / lu^2 */
static double norm2_of(const trimesh_weights *r) {
  const double one = 1.0 / (1 << TRIMESH_WEIGHT_BITS);
  const double u[3] = {r->u1 * one, r->u2 * one, (r->u1 + (double)r->u2) * one};
  const double v[3] = {r->v1 * one, r->v2 * one, (r->v1 + (double)r->v2) * one};
  double uu = 0, vv = 0, uv = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    uu += u[k] * u[k];
    vv += v[k] * v[k];
    uv += u[k] * v[k];
  }
  return (uu + vv) / 2 + hypot((uu - vv) / 2, uv);
}

/* The length of a lu, m: the mesh has the scene's area. */
static double lu_of(const sheet *s, const fray_world *w) {
  double area = 0;
  for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t) area += w->trimesh.area[t] / 1073741824.0;
  return sqrt(s->cell[0] * s->cell[1] * s->columns * s->rows / area) / 100;
}

typedef struct {
  double rest, torn;
  uint32_t refused, tears, softened, largest, whole;
} tally;

static double largest(const sheet *s, const fray_world *w, double lu, tally *total) {
  const double h = 1 / (s->rate * w->params->substeps * w->membrane.constants->steps);
  const double c = stiffest(&w->membrane.materials[0]);
  double most = 0;
  for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t) {
    const double kept = membrane_softening(w, t) / 1073741824.0;
    const double norm2 = norm2_of(&w->trimesh.weights[t]);
    total->softened += kept < 1;
    most = fmax(most, kept * 3 * h * h / s->density * norm2 / (lu * lu) * c);
    /* as the runtime's own constants have it */
    const double own = 4096.0 * ldexp(w->membrane.constants->force_gain, -30 - w->membrane.constants->force_shift) *
                       w->membrane.constants->mass_unit / 1073741824.0 / w->membrane.constants->steps;
    CHECK(fabs(own / (3 * h * h / s->density / (lu * lu)) - 1) < 1e-3);
  }
  return most;
}

static void tear_some(fray_world *w) {
  trimesh_ring ring;
  trimesh_ray from;
  trimesh_ray to;
  trimesh_cut_vertices cut;
  const int32_t du = (int32_t)below(1u << 31) - (1 << 30), dv = (int32_t)below(1u << 31) - (1 << 30);
  if (below(2) == 0) {
    (void)trimesh_cut_edge(w, below((uint32_t)w->trimesh.state->triangles), below(3), below(TRIMESH_WEIGHT_ONE + 1), du,
                           dv, &cut);
    return;
  }
  const uint32_t vertex = below(w->p.count);
  const trimesh_point centre = trimesh_at(&w->trimesh, vertex);
  trimesh_ring_of(&w->trimesh, vertex, &ring);
  if (trimesh_ray_along(&w->trimesh, &ring, centre, du, dv, &from) &&
      (ring.closed == 0 || trimesh_ray_along(&w->trimesh, &ring, centre, -du, -dv, &to)))
    (void)trimesh_split(w, vertex, &from, &to, TRIMESH_TORN);
}

static uint32_t operations(const fray_world *w) { return w->p.count + (uint32_t)w->trimesh.state->triangles; }

static void try_sheet(const sheet *s, tally *total) {
  fixture_scoped f = {0};
  scene_error error;
  if (!fixture_compile(&f, "test", s->text, &error)) {
    CHECK(strstr(error.message, "expected") != NULL && error.line != 0);
    ++total->refused;
    return;
  }
  fixture_open_image(&f);
  const double lu = lu_of(s, f.w);
  const uint32_t softened = total->softened;
  const double rest = largest(s, f.w, lu, total);
  CHECK_EQ_INT(total->softened, softened);
  if (!(rest <= asked)) printf("%.4g at rest of\n%s", rest, s->text);
  CHECK(rest <= asked);
  total->rest = fmax(total->rest, rest);
  for (uint32_t n = 0; n < 40 && total->tears < TEARS; ++n) {
    const uint32_t before = operations(f.w);
    tear_some(f.w);
    total->tears += operations(f.w) != before;
  }
  const double torn = largest(s, f.w, lu, total);
  if (!(torn <= asked)) printf("%.4g torn of\n%s", torn, s->text);
  CHECK(torn <= asked);
  total->torn = fmax(total->torn, torn);
}

static void no_triangle_is_too_fast(void) {
  tally total = {0};
  sheet s;
  for (uint32_t n = 0; n < SCENES; ++n) {
    draw_sheet(&s);
    try_sheet(&s, &total);
  }
  CHECK(total.tears >= TEARS && total.softened > TEARS / 10);
  CHECK(total.refused < SCENES / 8);
  printf("figure elastic_step_rest %.4g of 4 (asked: %.2g), after %u tears %.4g; %u triangles softened, %u of %d "
         "scenes refused\n",
         total.rest, asked, total.tears, total.torn, total.softened, total.refused, SCENES);
}

int main(void) {
  TEST(no_triangle_is_too_fast);
  return test_end();
}
