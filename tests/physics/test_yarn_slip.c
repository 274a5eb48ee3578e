/* SPDX-License-Identifier: Apache-2.0 */
/* The slip constraint: a million random pairs of springs, with ends that are light, whole or held. One
 * application brings the gap to T, momentum stays the same to the last bit. */
#include "tests/lib/test.h"

#include "rt/woven/yarn_slip.h"
#include "rt/woven/woven.h"
#include "tests/lib/yarn_check.h"

enum { PAIRS = 1000000, ENDS = 4 };

/* A row held along the top; below it whole crossings and couples. */
static void open_sheet(fixture *f) {
  fixture_print(f, "scene slip\nrate 1000 Hz\nsubsteps 4\nseed 5\nwoven {\n warps 8\n wefts 8\n"
                   " spacing 12 /cm\n yarns on\n}\npin row top\n");
  for (uint32_t c = 32; c < 64; ++c) crossing_split(f->w, c, FRAY_LOOSE);
}

static int32_t within(uint64_t *seed, int32_t range) {
  return (int32_t)(splitmix64(seed) % (2u * (uint32_t)range + 1u)) - range;
}

static uint32_t other_end(uint64_t *seed, uint32_t own) {
  uint32_t p = own;
  while (p == own) p = (uint32_t)(splitmix64(seed) % 96);
  return p;
}

/* A warp and a weft spring of about a spacing, less than twice T apart at the chosen points. */
static yarn_slip_pair place_pair(fray_world *w, uint64_t *seed) {
  const uint32_t c = 32 + (uint32_t)(splitmix64(seed) % 32);
  yarn_slip_pair k = {{w->woven.warp_particle[c], 0, w->woven.crossing_particle[c], 0}, {0, 0, 0, 0}};
  do {
    k.particle[1] = other_end(seed, k.particle[0]);
    k.particle[3] = other_end(seed, k.particle[2]);
  } while (k.particle[1] == k.particle[2] || k.particle[3] == k.particle[0] || k.particle[1] == k.particle[3]);
  for (uint32_t n = 1; n < ENDS; n += 2) {
    const uint32_t kind = (uint32_t)(splitmix64(seed) % 8);
    k.weight[n] = kind == 0 ? 0 : kind == 1 ? YARN_SLIP_ONE : (int32_t)(splitmix64(seed) % (YARN_SLIP_ONE + 1));
    k.weight[n - 1] = YARN_SLIP_ONE - k.weight[n];
  }
  int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
  for (uint32_t axis = 0; axis < 3; ++axis) {
    for (uint32_t n = 0; n < ENDS; ++n) {
      at[axis][k.particle[n]] = within(seed, FX_LU / 10);
      w->p.vx[k.particle[n]] = within(seed, 1 << 20);
    }
  }
  const vec3 gap = yarn_slip_gap(w, &k);
  const int32_t off[3] = {gap.x, gap.y, gap.z};
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const int32_t shift = off[axis] + within(seed, w->params->thickness * 3 / 2);
    at[axis][k.particle[0]] -= shift;
    at[axis][k.particle[1]] -= shift;
  }
  return k;
}

static double gap_of(const fray_world *w, const yarn_slip_pair *k, double unit[3]) {
  const int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
  double length = 0;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    unit[axis] = 0;
    for (uint32_t n = 0; n < ENDS; ++n)
      unit[axis] += (n < 2 ? 1 : -1) * (k->weight[n] / (double)YARN_SLIP_ONE) * at[axis][k->particle[n]];
    length += unit[axis] * unit[axis];
  }
  length = sqrt(length);
  for (uint32_t axis = 0; axis < 3; ++axis) unit[axis] /= length > 0 ? length : 1;
  return length;
}

/* Half crossings times Q28; what the body gave taken away. */
static void momentum(const fray_world *w, const yarn_slip_pair *k, int64_t sum[3]) {
  const int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
  const int32_t *const v[3] = {w->p.vx, w->p.vy, w->p.vz};
  for (uint32_t axis = 0; axis < 3; ++axis) {
    sum[axis] = -2 * w->rigid.motion[0].impulse[axis];
    for (uint32_t n = 0; n < ENDS; ++n) {
      const uint32_t p = k->particle[n];
      if (p < (uint32_t)w->params->attached) continue;
      const int64_t mass = particle_is_half(w, p) ? 1 : 2;
      sum[axis] += mass * ((int64_t)at[axis][p] * 16 + v[axis][p]);
    }
  }
}

static void one_application_brings_the_gap_to_t(void) {
  fixture_scoped f = {0};
  uint64_t seed = 20092;
  double worst = 0;
  uint32_t moved = 0;
  uint32_t lost = 0;
  uint32_t kinds[3] = {0, 0, 0};
  open_sheet(&f);
  for (uint32_t n = 0; n < PAIRS; ++n) {
    const yarn_slip_pair k = place_pair(f.w, &seed);
    const double t = f.w->params->thickness;
    double unit[3];
    int64_t before[3], after[3];
    memset(f.w->rigid.motion, 0, f.w->capacity[POOL_BODIES] * sizeof *f.w->rigid.motion);
    const double d = gap_of(f.w, &k, unit);
    if (d < t / 8) continue;
    momentum(f.w, &k, before);
    const vec3 by = vec_make((int32_t)lrint((t - d) * unit[0]), (int32_t)lrint((t - d) * unit[1]),
                             (int32_t)lrint((t - d) * unit[2]));
    if (!yarn_slip_move(f.w, &k, by, 0)) continue;
    ++moved;
    for (uint32_t e = 1; e < ENDS; e += 2)
      ++kinds[k.particle[e] < (uint32_t)f.w->params->attached ? 0 : particle_is_half(f.w, k.particle[e]) ? 2 : 1];
    const double off = fabs(gap_of(f.w, &k, unit) - t);
    if (off > worst) worst = off;
    momentum(f.w, &k, after);
    lost += memcmp(before, after, sizeof before) != 0;
  }
  figure("slip_gap_off_at_most", worst, "LSB", "2");
  figure("slip_pairs", moved, "", "a million drawn");
  printf("  far ends: %u held, %u whole, %u light\n", kinds[0], kinds[1], kinds[2]);
  CHECK(worst <= 2);
  CHECK_EQ_INT(lost, 0);
  CHECK(moved > PAIRS * 9 / 10 && kinds[0] > 1000 && kinds[1] > 1000 && kinds[2] > 1000);
}

/* A quiet move changes no velocity after the substep: the predicted position goes along. */
static void a_quiet_move_gives_no_velocity(void) {
  fixture_scoped f = {0};
  uint64_t seed = 3;
  open_sheet(&f);
  for (uint32_t n = 0; n < 1000; ++n) {
    const yarn_slip_pair k = place_pair(f.w, &seed);
    int32_t before[ENDS];
    for (uint32_t e = 0; e < ENDS; ++e) before[e] = f.w->p.x[k.particle[e]] - f.w->p.qx[k.particle[e]];
    const int32_t speed = f.w->p.vx[k.particle[0]];
    yarn_slip_move(f.w, &k, vec_make(40000, -20000, 1000), 1);
    for (uint32_t e = 0; e < ENDS; ++e) CHECK_EQ_INT(f.w->p.x[k.particle[e]] - f.w->p.qx[k.particle[e]], before[e]);
    CHECK_EQ_INT(f.w->p.vx[k.particle[0]], speed);
  }
}

/* Two yarns crossed at right angles; the warp, over the weft, was pushed to the other side by 2 T. */
static void a_yarn_that_was_pushed_through_comes_back(void) {
  fixture_scoped f = {0};
  open_sheet(&f);
  fray_world *w = f.w;
  const uint32_t c = 5 * 8 + 3;
  const int over = crossing_warp_over(w, c);
  const int32_t t = w->params->thickness;
  w->p.z[w->woven.warp_particle[c]] -= (over ? 1 : -1) * t * 3 / 2;
  double distance = 0;
  for (uint32_t n = 0; n < 12; ++n) {
    memcpy(w->p.qx, w->p.x, w->p.count * sizeof *w->p.x);
    memcpy(w->p.qy, w->p.y, w->p.count * sizeof *w->p.y);
    memcpy(w->p.qz, w->p.z, w->p.count * sizeof *w->p.z);
    yarn_slip_apply(w, 0);
  }
  distance = (double)(w->p.z[w->woven.warp_particle[c]] - w->p.z[w->woven.crossing_particle[c]]) * (over ? 1 : -1);
  figure("pushed_through_ends_at", distance / t, "T", "near 1");
  CHECK(distance > 0.9 * t && distance < 1.1 * t);
}

/* A flat loose sheet, its particles T apart: springs that change sides come a little nearer to each
 * other beside the crossing, so couples end up some percents farther apart, and stay there. */
static void what_is_t_apart_stays(void) {
  fixture_scoped f = {0};
  open_sheet(&f);
  fray_world *w = f.w;
  uint32_t moved = 0;
  int32_t *before = malloc(w->p.count * sizeof *before);
  if (before == NULL) fixture_give_up("test", "out of memory");
  memcpy(before, w->p.z, w->p.count * sizeof *before);
  for (uint32_t n = 0; n < 100; ++n) yarn_slip_apply(w, 0);
  for (uint32_t p = 0; p < w->p.count; ++p)
    moved += fx_magnitude(w->p.z[p] - before[p]) > (uint32_t)w->params->thickness / 50u;
  CHECK_EQ_INT(moved, 0);
  memcpy(before, w->p.z, w->p.count * sizeof *before);
  yarn_slip_apply(w, 0);
  for (uint32_t p = 0; p < w->p.count; ++p) moved += fx_magnitude(w->p.z[p] - before[p]) > 2;
  CHECK_EQ_INT(moved, 0);
  free(before);
}

/* A warp that slides over its weft by `slip` in a substep: what friction leaves of it. */
static int32_t left_of_slip(int32_t grip, int32_t slip) {
  fixture_scoped f = {0};
  open_sheet(&f);
  fray_world *w = f.w;
  const uint32_t c = 5 * 8 + 3;
  const uint32_t warp = w->woven.warp_particle[c];
  const uint32_t weft = w->woven.crossing_particle[c];
  for (uint32_t n = 0; n < 50; ++n) yarn_slip_apply(w, 0);
  memcpy(w->p.qx, w->p.x, w->p.count * sizeof *w->p.x);
  memcpy(w->p.qy, w->p.y, w->p.count * sizeof *w->p.y);
  memcpy(w->p.qz, w->p.z, w->p.count * sizeof *w->p.z);
  memset(w->p.vx, 0, w->p.count * sizeof *w->p.vx);
  memset(w->p.vy, 0, w->p.count * sizeof *w->p.vy);
  memset(w->p.vz, 0, w->p.count * sizeof *w->p.vz);
  w->p.vx[warp] = slip * 16;
  ((yarn_params *)(uintptr_t)w->woven.yarn_constants)->crossing_friction = grip;
  /* this couple alone */
  for (uint32_t other = 0; other < 64; ++other)
    if (other != c && crossing_state_at(w, other) == FRAY_LOOSE) crossing_set_state(w, other, FRAY_DISCONNECTED);
  yarn_slip_apply(w, 0);
  const int32_t left = w->p.vx[warp] / 16 + w->p.x[warp] - w->p.qx[warp] -
                       (w->p.vx[weft] / 16 + w->p.x[weft] - w->p.qx[weft]);
  return left;
}

/* Closest points are a hundredth of a spring away from the particles. */
static int about(int32_t a, int32_t b) { return a - b <= 20 && b - a <= 20; }

static void friction_holds_or_brakes(void) {
  CHECK(about(left_of_slip(0, 1000), 1000)); /* the paper's: none */
  CHECK(about(left_of_slip(300, 1000), 700));
  CHECK(about(left_of_slip(1000, 1000), 0));
  CHECK(about(left_of_slip(5000, 1000), 0)); /* never more than stopped */
  CHECK(about(left_of_slip(300, -1000), -700));
}

int main(void) {
  TEST(one_application_brings_the_gap_to_t);
  TEST(a_quiet_move_gives_no_velocity);
  TEST(a_yarn_that_was_pushed_through_comes_back);
  TEST(what_is_t_apart_stays);
  TEST(friction_holds_or_brakes);
  return test_end();
}
