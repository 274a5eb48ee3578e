/* SPDX-License-Identifier: Apache-2.0 */
/* Splitting a crossing: what must stay the same to the last bit, where both halves go, what becomes of
 * the springs, and what a link or spring between unequal ends keeps. */
#include "tests/lib/test.h"

#include "platform/linux/cpu.h"
#include "rt/image/state_hash.h"
#include "rt/woven/woven.h"
#include "tests/lib/yarn_check.h"

static void open_sheet(fixture *f, const char *pattern, const char *more) {
  fixture_print(f,
                "scene split\nrate 1000 Hz\nsubsteps 4\nseed 5\nwoven {\n warps 12\n wefts 11\n"
                " spacing 12 /cm\n weave %s\n yarns on\n at 1 2 3 cm\n}\npin row top\n%s",
                pattern, more);
}

/* Places and speeds as a sheet in motion has them. */
static void shake(fixture *f, uint64_t *seed) {
  fray_world *w = f->w;
  for (uint32_t p = 0; p < w->p.count; ++p) {
    int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
    int32_t *const q[3] = {w->p.qx, w->p.qy, w->p.qz};
    int32_t *const v[3] = {w->p.vx, w->p.vy, w->p.vz};
    int8_t *const r[3] = {w->p.rx, w->p.ry, w->p.rz};
    for (uint32_t n = 0; n < 3; ++n) {
      at[n][p] += (int32_t)(splitmix64(seed) % 400001) - 200000;
      q[n][p] = at[n][p] + (int32_t)(splitmix64(seed) % 2001) - 1000;
      v[n][p] = (int32_t)(splitmix64(seed) % 4000001) - 2000000;
      r[n][p] = (int8_t)((int32_t)(splitmix64(seed) % 17) - 8);
    }
  }
}

typedef struct {
  int64_t at[3], q[3], speed[3], rest[3];
} sums;

/* In half crossings. */
static sums sum_up(const fray_world *w) {
  sums s = {0};
  for (uint32_t p = 0; p < w->p.count; ++p) {
    const int64_t mass = particle_is_half(w, p) ? 1 : 2;
    const int32_t at[3] = {w->p.x[p], w->p.y[p], w->p.z[p]};
    const int32_t q[3] = {w->p.qx[p], w->p.qy[p], w->p.qz[p]};
    const int32_t v[3] = {w->p.vx[p], w->p.vy[p], w->p.vz[p]};
    const int32_t r[3] = {w->p.rx[p], w->p.ry[p], w->p.rz[p]};
    for (uint32_t n = 0; n < 3; ++n) {
      s.at[n] += mass * at[n];
      s.q[n] += mass * q[n];
      s.speed[n] += mass * v[n];
      s.rest[n] += mass * r[n];
    }
  }
  return s;
}

static void a_split_keeps_its_sums(void) {
  uint64_t seed = 1;
  uint32_t splits = 0;
  for (uint32_t trial = 0; trial < 20; ++trial) {
    fixture_scoped f = {0};
    CLOSED_BY(yarn_check_close) yarn_check k = {0};
    open_sheet(&f, trial % 2 == 0 ? "plain" : "twill 2/1", "");
    shake(&f, &seed);
    yarn_check_open(&k, &f);
    while (f.w->p.count < f.w->capacity[POOL_PARTICLES]) {
      const uint32_t c = (uint32_t)(splitmix64(&seed) % f.w->capacity[POOL_CROSSINGS]);
      if (crossing_state_at(f.w, c) != FRAY_WHOLE || crossing_is_attached(f.w, c)) {
        if ((uint32_t)f.w->woven.yarn_counts->split == f.w->capacity[POOL_CROSSINGS] - 12) break;
        continue;
      }
      const sums before = sum_up(f.w);
      CHECK_EQ_INT(crossing_split(f.w, c, FRAY_LOOSE), 1);
      const sums after = sum_up(f.w);
      CHECK(memcmp(&before, &after, sizeof before) == 0);
      yarn_check_tick(&k, &f);
      ++splits;
    }
    CHECK_EQ_INT(k.bad, 0);
  }
  figure("splits_that_keep_every_sum", splits, "", "all");
}

/* Which yarn is over the other is the weave's, and shows in pictures. */
static void halves_lie_where_the_crossing_was(void) {
  fixture_scoped f = {0};
  open_sheet(&f, "twill 2/1", "");
  for (uint32_t c = 12; c < 132; ++c) {
    const vec3 at = world_position(f.w, fray_crossing_particle(f.w, c));
    CHECK_EQ_INT(crossing_split(f.w, c, FRAY_LOOSE), 1);
    CHECK(vec_is_equal(world_position(f.w, fray_yarn_particle(f.w, c, FRAY_WARP)), at));
    CHECK(vec_is_equal(world_position(f.w, fray_yarn_particle(f.w, c, FRAY_WEFT)), at));
    CHECK_EQ_INT(f.w->woven.contacts[crossing_contact(f.w, c)].place[FRAY_WARP], yarn_place_of(c / 12));
    CHECK_EQ_INT(f.w->woven.contacts[crossing_contact(f.w, c)].place[FRAY_WEFT], yarn_place_of(c % 12));
    CHECK_EQ_INT(fray_crossing_state_at(f.w, c), FRAY_LOOSE);
  }
}

static void it_stops_where_no_particle_is_left(void) {
  fixture_scoped f = {0};
  open_sheet(&f, "plain", "limits {\n spare_particles 3\n}\n");
  const uint64_t whole = state_hash(f.w);
  for (uint32_t c = 20; c < 23; ++c) CHECK_EQ_INT(crossing_split(f.w, c, FRAY_LOOSE), 1);
  const uint64_t full = state_hash(f.w);
  CHECK(whole != full);
  CHECK_EQ_INT(crossing_split(f.w, 30, FRAY_LOOSE), 0);
  CHECK(state_hash(f.w) == full);
  CHECK_EQ_INT(fray_view_particles(f.w).count, 135);
}

/* Links and springs of a sheet where every other crossing has split: rows between light, whole and
 * held ends. Momentum, in half crossings, is what the bodies gave. */
static void rows_between_unequal_ends_keep_momentum(void) {
  uint64_t seed = 9;
  for (uint32_t trial = 0; trial < 40; ++trial) {
    fixture_scoped f = {0};
    open_sheet(&f, "plain", "");
    shake(&f, &seed);
    for (uint32_t c = 12; c < 132; ++c)
      if (splitmix64(&seed) % 2 == 0) crossing_split(f.w, c, FRAY_LOOSE);
    memset(f.w->rigid.motion, 0, f.w->capacity[POOL_BODIES] * sizeof *f.w->rigid.motion);
    const sums before = sum_up(f.w);
    if (trial % 2 == 0)
      strain_limit_apply(f.w);
    else
      bend_shear_apply(f.w);
    const sums after = sum_up(f.w);
    const int64_t *gave = f.w->rigid.motion[0].impulse;
    for (uint32_t n = 0; n < 3; ++n) {
      CHECK_EQ_INT(after.at[n] - before.at[n], trial % 2 == 0 ? gave[n] / 8 : 0);
      CHECK_EQ_INT(after.speed[n] - before.speed[n], trial % 2 == 0 ? 0 : gave[n] * 2);
      CHECK_EQ_INT(trial % 2 == 0 ? gave[n] % 8 : 0, 0);
    }
  }
}

/* A light end goes twice as far as a whole one. */
static void a_light_end_takes_two_thirds(void) {
  fixture_scoped f = {0};
  open_sheet(&f, "plain", "");
  const uint32_t c = 5 * 12 + 5; /* whole, and the next one split */
  crossing_split(f.w, c + 1, FRAY_LOOSE);
  const uint32_t i = fray_yarn_particle(f.w, c, FRAY_WEFT);
  const uint32_t j = fray_yarn_particle(f.w, c + 1, FRAY_WEFT);
  for (uint32_t row = 0; row < f.w->capacity[POOL_SPRINGS]; ++row)
    if (!((f.w->woven.spring_i[row] == i && f.w->woven.spring_j[row] == j) ||
          (f.w->woven.spring_i[row] == j && f.w->woven.spring_j[row] == i)))
      world_kill_spring(f.w, row);
  f.w->p.x[j] += 100000;
  const int32_t before[2] = {f.w->p.x[i], f.w->p.x[j]};
  strain_limit_apply(f.w);
  const int32_t moved_i = f.w->p.x[i] - before[0];
  const int32_t moved_j = f.w->p.x[j] - before[1];
  CHECK(moved_i > 1000);
  CHECK_EQ_INT(moved_j, -2 * moved_i);
}

/* The kernels of this machine against the scalar one, over a sheet that is part yarn. */
static void simd_kernels_agree(void) {
  static const fray_kernel kernels[] = {FRAY_KERNEL_AVX2, FRAY_KERNEL_AVX512, FRAY_KERNEL_NEON};
  uint32_t compared = 0;
  for (uint32_t n = 0; n < sizeof kernels / sizeof kernels[0]; ++n) {
    fixture_scoped f = {0}, g = {0};
    uint64_t seed = 77;
    open_sheet(&f, "twill 2/2", "");
    open_sheet(&g, "twill 2/2", "");
    if (cpu_has(kernels[n]) && fray_set_kernel(g.w, kernels[n])) {
      ++compared;
      for (uint32_t c = 12; c < 132; ++c)
        if (splitmix64(&seed) % 2 == 0) {
          crossing_split(f.w, c, FRAY_LOOSE);
          crossing_split(g.w, c, FRAY_LOOSE);
        }
      for (uint32_t tick = 0; tick < 200; ++tick)
        CHECK(fixture_tick(&f, &fixture_idle).hash == fixture_tick(&g, &fixture_idle).hash);
    }
  }
  printf("  %u kernels compared\n", compared);
}

int main(void) {
  TEST(a_split_keeps_its_sums);
  TEST(halves_lie_where_the_crossing_was);
  TEST(it_stops_where_no_particle_is_left);
  TEST(rows_between_unequal_ends_keep_momentum);
  TEST(a_light_end_takes_two_thirds);
  TEST(simd_kernels_agree);
  return test_end();
}
