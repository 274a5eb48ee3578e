/* SPDX-License-Identifier: Apache-2.0 */
/* A ball against cloths 1 to 4 of Table 4.1 (Karaoz 2015, section 4.2; tests/scenes/cracks): what their
 * tears look like, on three meshes. Lengths are those at rest; vertical is along the warp, within 22.5
 * degrees. */
#include "tests/lib/test.h"

#include "tests/lib/crack.h"

enum { MESHES = 3, TURNED = 1, ONE_CELL = 5 /* cm */ };
static const char *const meshes[MESHES] = {"pattern regular", "pattern rotated 30 deg", "pattern irregular 3"};

typedef struct {
  crack_map map;
  uint32_t vertical, horizontal; /* tears side by side at the end */
  uint32_t first[2]; /* ticks when so much as a cell was vertical, and nearer to horizontal; 0: never */
  double speed[2];   /* of the ball, cm/s: at the second one, and at the end */
  double start_j, most_j; /* energy */
} outcome;

static double squared(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Of a triangle, J: with the whole stiffness, also where that is less in what a tear left. */
static double stored(const fray_world *w, uint32_t t, double lu_m) {
  const trimesh_weights *r = &w->trimesh.weights[t];
  const int32_t *c = w->membrane.materials[0].stretch[0];
  double u[3], v[3];
  const int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
  for (uint32_t n = 0; n < 3; ++n) {
    const double d1 = (at[n][w->trimesh.triangle[t].v[1]] - (double)at[n][w->trimesh.triangle[t].v[0]]) * 0x1p-46;
    const double d2 = (at[n][w->trimesh.triangle[t].v[2]] - (double)at[n][w->trimesh.triangle[t].v[0]]) * 0x1p-46;
    u[n] = d1 * r->u1 + d2 * r->u2;
    v[n] = d1 * r->v1 + d2 * r->v2;
  }
  const double uu = (squared(u, u) - 1) / 2, vv = (squared(v, v) - 1) / 2, uv = squared(u, v);
  const double density = (c[0] * uu * uu + c[2] * vv * vv + c[3] * uv * uv) / 2 + c[1] * uu * vv;
  return density * 0x1p-12 * w->trimesh.area[t] * 0x1p-30 * lu_m * lu_m;
}

static double energy(const fixture *f, double ball_kg) {
  const fray_world *w = f->w;
  const double m_s = fixture_speed(f) / 100;
  const double kg = fixture_mass_g(f) / 1000 / w->membrane.constants->mass_unit;
  const fray_body ball = fray_view_body(w, 0);
  double sum = 0;
  for (uint32_t n = 0; n < 3; ++n) sum += pow(ball.velocity[n] * m_s, 2) * ball_kg / 2;
  for (uint32_t p = (uint32_t)w->params->attached; p < w->p.count; ++p)
    sum += (pow(w->p.vx[p], 2) + pow(w->p.vy[p], 2) + pow(w->p.vz[p], 2)) * m_s * m_s * w->trimesh.mass[p] * kg / 2;
  for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t)
    sum += stored(w, t, fixture_lu_cm(f) / 100);
  return sum;
}

static double ball_speed(const fixture *f) { return fabs((double)fray_view_body(f->w, 0).velocity[2]) * fixture_speed(f); }

static void watch_tear(const fixture *f, uint32_t tick, outcome *o) {
  crack_find(&o->map, f);
  if (o->first[0] == 0 && o->map.share[0] * o->map.length >= 0.9 * ONE_CELL) o->first[0] = tick;
  if (o->first[1] != 0 || o->map.flat < 0.9 * ONE_CELL) return;
  o->first[1] = tick;
  o->speed[0] = ball_speed(f);
}

static void run_cloth(uint32_t cloth, uint32_t mesh, uint32_t ticks, outcome *o) {
  char path[64];
  fixture_scoped f = {0};
  snprintf(path, sizeof path, "tests/scenes/cracks/cloth_%u.scene", cloth);
  fixture_file(&f, path, "pattern regular", meshes[mesh], NULL);
  const fray_work most = fray_work_bound(f.w);
  uint32_t over = 0, faults = 0;
  memset(o, 0, sizeof *o);
  o->start_j = energy(&f, 10);
  for (uint32_t tick = 1; tick <= ticks; ++tick) {
    const fray_output out = fixture_tick(&f, &fixture_idle);
    over += !fixture_within_bound(&out.work, &most);
    faults |= out.faults;
    if (out.work.tears != 0) watch_tear(&f, tick, o);
    if (tick % 16 == 0) o->most_j = fmax(o->most_j, energy(&f, 10));
  }
  crack_find(&o->map, &f);
  o->vertical = crack_parallel_count(&f, 0, ONE_CELL / 3.0);
  o->horizontal = crack_parallel_count(&f, 1, ONE_CELL / 3.0);
  o->speed[1] = ball_speed(&f);
  const crack_map *m = &o->map;
  printf("figure cloth_%u %-18s %4.0f cm: %.2f vertical %.2f horizontal %.2f %.2f aslant; side by side %u "
         "vertical %u horizontal; %u apart, %.2f in one; from ticks %u %u; energy %.3f\n",
         cloth, meshes[mesh], m->length, m->share[0], m->share[2], m->share[1], m->share[3], o->vertical,
         o->horizontal, m->cracks, m->crack[0].length / m->length, o->first[0], o->first[1],
         o->most_j / o->start_j);
  CHECK_EQ_INT(over, 0);
  CHECK_EQ_INT(faults, 0);
  CHECK(o->most_j <= o->start_j * 1.001);
}

/* In several directions: at least three have a tenth, none has more than 0.6. */
static void cloth_1_tears_in_several_directions(void) {
  for (uint32_t mesh = 0; mesh < MESHES; ++mesh) {
    outcome o;
    uint32_t ways = 0;
    run_cloth(1, mesh, 480, &o);
    for (uint32_t n = 0; n < CRACK_DIRECTIONS; ++n) {
      CHECK(o.map.share[n] <= 0.6);
      ways += o.map.share[n] >= 0.1;
    }
    CHECK(ways >= 3);
  }
}

/* One tear, all that is torn hangs together, from side to side, and it is horizontal: at most a tenth longer than
 * the cloth is wide, and by the directions of its sides: the turned mesh has them at -15 and 30 degrees, so that the
 * straightest way has 0.66 of it horizontal. */
static void cloth_2_tears_once_horizontally(void) {
  for (uint32_t mesh = 0; mesh < MESHES; ++mesh) {
    outcome o;
    run_cloth(2, mesh, 480, &o);
    const crack *c = &o.map.crack[0];
    CHECK(o.map.length <= 1.1 * 150);
    CHECK(o.map.share[2] >= (mesh == TURNED ? 0.66 : 0.8));
    CHECK(o.map.share[0] <= 0.05);
    CHECK_EQ_INT(o.map.cracks, 1);
    CHECK(c->high[0] - c->low[0] >= 149 && c->high[1] - c->low[1] <= 20);
  }
}

/* Vertical tears side by side; long after them a horizontal one joins them, and only then the ball is
 * through: most of the speed that it loses is lost by then. */
static void cloth_3_tears_vertically_then_once_horizontally(void) {
  for (uint32_t mesh = 0; mesh < MESHES; ++mesh) {
    outcome o;
    run_cloth(3, mesh, 600, &o);
    CHECK(o.map.share[0] >= 0.75);
    CHECK(o.vertical >= 2);
    CHECK(o.first[0] != 0 && o.first[1] >= o.first[0] + 100);
    CHECK(o.map.crack[0].length >= 0.6 * o.map.length);
    figure("ball_speed_when_joined", o.speed[0], "cm/s", "three fifths of what it loses lost");
    figure("ball_speed_at_the_end", o.speed[1], "cm/s", "printed");
    CHECK(100 - o.speed[0] >= 0.6 * (100 - o.speed[1]));
  }
}

/* Many vertical tears: at least three side by side, six tenths of the length and more. */
static void cloth_4_tears_vertically_often(void) {
  for (uint32_t mesh = 0; mesh < MESHES; ++mesh) {
    outcome o;
    run_cloth(4, mesh, 400, &o);
    CHECK(o.map.share[0] >= 0.6);
    CHECK(o.map.share[2] <= 0.25);
    CHECK(o.vertical >= 3);
  }
}

int main(void) {
  TEST(cloth_1_tears_in_several_directions);
  TEST(cloth_2_tears_once_horizontally);
  TEST(cloth_3_tears_vertically_then_once_horizontally);
  TEST(cloth_4_tears_vertically_often);
  return test_end();
}
