/* SPDX-License-Identifier: Apache-2.0 */
/* Points of two links moved apart: a million random pairs, with ends that are light, whole or held. One move
 * brings the gap to what was asked, momentum stays the same to the last bit. */
#include "tests/lib/test.h"

#include "rt/woven/yarn_pair.h"
#include "tests/lib/yarn_check.h"

enum { PAIRS = 1000000, ENDS = 4 };

/* A row held along the top; below it whole crossings and couples. */
static void open_sheet(fixture *f) {
  fixture_print(f, "scene pair\nrate 1000 Hz\nsubsteps 4\nseed 5\nwoven {\n warps 8\n wefts 8\n"
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
static yarn_pair place_pair(fray_world *w, uint64_t *seed) {
  const uint32_t c = 32 + (uint32_t)(splitmix64(seed) % 32);
  yarn_pair k = {{w->woven.warp_particle[c], 0, w->woven.crossing_particle[c], 0}, {0, 0, 0, 0}};
  do {
    k.particle[1] = other_end(seed, k.particle[0]);
    k.particle[3] = other_end(seed, k.particle[2]);
  } while (k.particle[1] == k.particle[2] || k.particle[3] == k.particle[0] || k.particle[1] == k.particle[3]);
  for (uint32_t n = 1; n < ENDS; n += 2) {
    const uint32_t kind = (uint32_t)(splitmix64(seed) % 8);
    k.weight[n] = kind == 0 ? 0 : kind == 1 ? YARN_PAIR_ONE : (int32_t)(splitmix64(seed) % (YARN_PAIR_ONE + 1));
    k.weight[n - 1] = YARN_PAIR_ONE - k.weight[n];
  }
  int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
  for (uint32_t axis = 0; axis < 3; ++axis) {
    for (uint32_t n = 0; n < ENDS; ++n) {
      at[axis][k.particle[n]] = within(seed, FX_LU / 10);
      w->p.vx[k.particle[n]] = within(seed, 1 << 20);
    }
  }
  const vec3 gap = yarn_pair_gap(w, &k);
  const int32_t off[3] = {gap.x, gap.y, gap.z};
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const int32_t shift = off[axis] + within(seed, w->params->thickness * 3 / 2);
    at[axis][k.particle[0]] -= shift;
    at[axis][k.particle[1]] -= shift;
  }
  return k;
}

static double gap_of(const fray_world *w, const yarn_pair *k, double unit[3]) {
  const int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
  double length = 0;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    unit[axis] = 0;
    for (uint32_t n = 0; n < ENDS; ++n)
      unit[axis] += (n < 2 ? 1 : -1) * (k->weight[n] / (double)YARN_PAIR_ONE) * at[axis][k->particle[n]];
    length += unit[axis] * unit[axis];
  }
  length = sqrt(length);
  for (uint32_t axis = 0; axis < 3; ++axis) unit[axis] /= length > 0 ? length : 1;
  return length;
}

/* Half crossings times Q28; what the body gave taken away. */
static void momentum(const fray_world *w, const yarn_pair *k, int64_t sum[3]) {
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
    const yarn_pair k = place_pair(f.w, &seed);
    const double t = f.w->params->thickness;
    double unit[3];
    int64_t before[3], after[3];
    memset(f.w->rigid.motion, 0, f.w->capacity[POOL_BODIES] * sizeof *f.w->rigid.motion);
    const double d = gap_of(f.w, &k, unit);
    if (d < t / 8) continue;
    momentum(f.w, &k, before);
    const vec3 by = vec_make((int32_t)lrint((t - d) * unit[0]), (int32_t)lrint((t - d) * unit[1]),
                             (int32_t)lrint((t - d) * unit[2]));
    if (!yarn_pair_move(f.w, &k, by, 0)) continue;
    ++moved;
    for (uint32_t e = 1; e < ENDS; e += 2)
      ++kinds[k.particle[e] < (uint32_t)f.w->params->attached ? 0 : particle_is_half(f.w, k.particle[e]) ? 2 : 1];
    const double off = fabs(gap_of(f.w, &k, unit) - t);
    if (off > worst) worst = off;
    momentum(f.w, &k, after);
    lost += memcmp(before, after, sizeof before) != 0;
  }
  figure("pair_gap_off_at_most", worst, "LSB", "2");
  figure("pairs_moved", moved, "", "a million drawn");
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
    const yarn_pair k = place_pair(f.w, &seed);
    int32_t before[ENDS];
    for (uint32_t e = 0; e < ENDS; ++e) before[e] = f.w->p.x[k.particle[e]] - f.w->p.qx[k.particle[e]];
    const int32_t speed = f.w->p.vx[k.particle[0]];
    yarn_pair_move(f.w, &k, vec_make(40000, -20000, 1000), 1);
    for (uint32_t e = 0; e < ENDS; ++e) CHECK_EQ_INT(f.w->p.x[k.particle[e]] - f.w->p.qx[k.particle[e]], before[e]);
    CHECK_EQ_INT(f.w->p.vx[k.particle[0]], speed);
  }
}

int main(void) {
  TEST(one_application_brings_the_gap_to_t);
  TEST(a_quiet_move_gives_no_velocity);
  return test_end();
}
