/* SPDX-License-Identifier: Apache-2.0 */
/* Four garments' materials (Karaoz 2015, appendix A.2; tests/scenes/thesis): in the wind, shaken, torn by a ball
 * of 20 kg at 9 km/h; 5 s each with `all`, else their beginnings. */
#include "tests/lib/test.h"

#include "tests/lib/crack.h"
#include "tests/lib/depth.h"
#include "tests/lib/trimesh_check.h"
#include "tools/world/kernel.h"

#define FOLDER "tests/scenes/thesis/"

enum { MATERIALS = 4, TICKS_ALL = 5000 };
static const char *const materials[MATERIALS] = {"  material jeans", "  material shirt", "  material trousers",
                                                 "  material bathers"};
static int all;

typedef struct {
  double low[2], high[2]; /* of the lower border's middle, along x and z, cm */
  double longest;         /* a side, of its length at rest */
  double fastest;         /* of a vertex, m/s */
  double deepest;         /* of the thickness, in the ball */
  uint32_t tears, faults, over;
} outcome;

static double longest_side(const fray_world *w) {
  const trimesh *s = &w->trimesh;
  double longest = 0;
  for (uint32_t n = 0; n < 3 * (uint32_t)s->state->triangles; ++n) {
    const uint32_t a = s->triangle[n / 3].v[trimesh_next(n % 3)], b = s->triangle[n / 3].v[trimesh_previous(n % 3)];
    const double now = pow((double)w->p.x[a] - w->p.x[b], 2) + pow((double)w->p.y[a] - w->p.y[b], 2) +
                       pow((double)w->p.z[a] - w->p.z[b], 2);
    const double rest = pow((double)s->u[a] - s->u[b], 2) + pow((double)s->v[a] - s->v[b], 2);
    longest = fmax(longest, sqrt(now / rest));
  }
  return longest;
}

static double fastest_vertex(const fixture *f) {
  const fray_world *w = f->w;
  double most = 0;
  for (uint32_t p = 0; p < w->p.count; ++p)
    most = fmax(most, pow(w->p.vx[p], 2) + pow(w->p.vy[p], 2) + pow(w->p.vz[p], 2));
  return sqrt(most) * fixture_speed(f) / 100;
}

/* The vertex farthest down, in the middle. */
static uint32_t find_tip(const fray_world *w) {
  uint32_t tip = 0;
  double best = 1e30;
  for (uint32_t p = 0; p < w->p.count; ++p) {
    const double at = w->p.y[p] + 0.1 * fabs((double)w->p.x[p]);
    if (at < best) tip = p;
    best = fmin(best, at);
  }
  return tip;
}

static void run_garment(const char *path, uint32_t material, uint32_t ticks, fixture *f, outcome *o) {
  fixture_file(f, path, materials[0], materials[material], NULL);
  CHECK(kernel_use(f->w, NULL));
  const fray_work most = fray_work_bound(f->w);
  const uint32_t tip = find_tip(f->w);
  const int has_ball = f->facts.bodies != 0 && fray_view_body(f->w, 0).shape == FRAY_SPHERE;
  const double cm = fixture_lu_cm(f) * 0x1p-24;
  const outcome none = {{1e9, 1e9}, {-1e9, -1e9}, 0, 0, -1e9, 0, 0, 0};
  *o = none;
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    const fray_output out = fixture_tick(f, &fixture_idle);
    const double at[2] = {f->w->p.x[tip] * cm, f->w->p.z[tip] * cm};
    o->faults |= out.faults;
    o->over += !fixture_within_bound(&out.work, &most);
    o->tears = out.tears_total;
    for (uint32_t n = 0; n < 2; ++n) {
      o->low[n] = fmin(o->low[n], at[n]);
      o->high[n] = fmax(o->high[n], at[n]);
    }
    if (has_ball) o->deepest = fmax(o->deepest, depth_in_sphere(f->w, 0) / (f->facts.thickness * 0x1p-24));
    if (tick % 8 != 0) continue;
    o->longest = fmax(o->longest, longest_side(f->w));
    o->fastest = fmax(o->fastest, fastest_vertex(f));
  }
  CHECK_EQ_INT(o->faults, 0);
  CHECK_EQ_INT(o->over, 0);
}

static void print_outcome(const char *what, uint32_t material, uint32_t ticks, const outcome *o) {
  printf("figure garment_%s%-20s %.1f s: sides at most %.1f %% longer; %.1f m/s at most; %u tears; ", what,
         materials[material], ticks * 1e-3, 100 * (o->longest - 1), o->fastest, o->tears);
}
static void print_tip(const outcome *o) {
  printf("lower side %.0f to %.0f cm across, %.0f to %.0f cm in front\n", o->low[0], o->high[0], o->low[1], o->high[1]);
}

static void in_the_wind(void) {
  const uint32_t ticks = all ? TICKS_ALL : 300;
  for (uint32_t n = 0; n < MATERIALS; ++n) {
    fixture_scoped f = {0};
    outcome o;
    run_garment(FOLDER "garment_wind.scene", n, ticks, &f, &o);
    print_outcome("wind", n, ticks, &o);
    print_tip(&o);
    CHECK_EQ_INT(o.tears, 0);
    CHECK(o.high[1] - o.low[1] > 2); /* it moves */
  }
}

static void shaken(void) {
  const uint32_t ticks = all ? TICKS_ALL : 600;
  for (uint32_t n = 0; n < MATERIALS; ++n) {
    fixture_scoped f = {0};
    outcome o;
    run_garment(FOLDER "garment_shaken.scene", n, ticks, &f, &o);
    print_outcome("shaken", n, ticks, &o);
    print_tip(&o);
    CHECK_EQ_INT(o.tears, 0);
    CHECK(o.high[0] - o.low[0] > 15); /* follows to the left and right */
  }
}

/* The ball is through, slower, and on the ground at the end; the mesh is whole. */
static void torn_by_a_ball(void) {
  const uint32_t ticks = all ? TICKS_ALL : 300;
  for (uint32_t n = 0; n < MATERIALS; ++n) {
    static crack_map map;
    fixture_scoped f = {0};
    outcome o;
    trimesh_check k;
    run_garment(FOLDER "garment_torn.scene", n, ticks, &f, &o);
    const fray_body ball = fray_view_body(f.w, 0);
    crack_find(&map, &f);
    print_outcome("torn", n, ticks, &o);
    printf("%.0f cm, %.2f horizontal, %.2f vertical; in the ball by %.2f of the thickness (asked: 1)\n", map.length,
           map.share[2], map.share[0], fmax(0, o.deepest));
    CHECK(o.tears > 0);
    CHECK(ball.position[2] * 0x1p-24 * fixture_lu_cm(&f) > 40);
    CHECK(o.deepest <= 1);
    trimesh_check_open(&k, f.w);
    trimesh_check_now(&k, f.w);
    CHECK_EQ_INT(k.bad, 0);
  }
}

int main(int argc, char **argv) {
  all = argc > 1 && strcmp(argv[1], "all") == 0;
  TEST(in_the_wind);
  TEST(shaken);
  TEST(torn_by_a_ball);
  return test_end();
}
