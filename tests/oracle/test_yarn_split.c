/* SPDX-License-Identifier: Apache-2.0 */
/* Splitting a crossing: what must stay the same to the last bit, where both halves go, what becomes of
 * the springs, and what a link or spring between unequal ends keeps. */
#include "tests/lib/test.h"

#include "platform/linux/cpu.h"
#include "rt/stage/stage.h"
#include "tests/lib/yarn_check.h"

static void open_sheet(fixture *f, const char *pattern, const char *more) {
  fixture_print(f,
                "scene split\nrate 1000 Hz\nsubsteps 4\nseed 5\nsheet {\n warps 12\n wefts 11\n"
                " spacing 12 /cm\n weave %s\n yarns on\n at 1 2 3 cm\n}\npin row top\n%s",
                pattern, more);
}

/* Places and speeds as a sheet in motion has them. */
static void shake(fixture *f, uint64_t *seed) {
  fray_world *w = f->w;
  for (uint32_t p = 0; p < w->particles; ++p) {
    int32_t *const at[3] = {w->x, w->y, w->z};
    int32_t *const q[3] = {w->qx, w->qy, w->qz};
    int32_t *const v[3] = {w->vx, w->vy, w->vz};
    int8_t *const r[3] = {w->rx, w->ry, w->rz};
    for (uint32_t n = 0; n < 3; ++n) {
      at[n][p] += (int32_t)(fixture_random(seed) % 400001) - 200000;
      q[n][p] = at[n][p] + (int32_t)(fixture_random(seed) % 2001) - 1000;
      v[n][p] = (int32_t)(fixture_random(seed) % 4000001) - 2000000;
      r[n][p] = (int8_t)((int32_t)(fixture_random(seed) % 17) - 8);
    }
  }
}

typedef struct {
  int64_t at[3], q[3], speed[3], rest[3];
} sums;

/* In half crossings. */
static sums sum_up(const fray_world *w) {
  sums s;
  memset(&s, 0, sizeof s);
  for (uint32_t p = 0; p < w->particles; ++p) {
    const int64_t mass = couple_is_light(w, p) ? 1 : 2;
    const int32_t at[3] = {w->x[p], w->y[p], w->z[p]};
    const int32_t q[3] = {w->qx[p], w->qy[p], w->qz[p]};
    const int32_t v[3] = {w->vx[p], w->vy[p], w->vz[p]};
    const int32_t r[3] = {w->rx[p], w->ry[p], w->rz[p]};
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
    fixture f;
    yarn_check k;
    open_sheet(&f, trial % 2 == 0 ? "plain" : "twill 2/1", "");
    shake(&f, &seed);
    yarn_check_open(&k, &f);
    while (f.w->particles < f.w->capacity[POOL_PARTICLES]) {
      const uint32_t c = (uint32_t)(fixture_random(&seed) % f.w->capacity[POOL_CROSSINGS]);
      if (couple_at(f.w, c) != FRAY_WHOLE || couple_is_held(f.w, c)) {
        if ((uint32_t)f.w->yarn_state->split == f.w->capacity[POOL_CROSSINGS] - 12) break;
        continue;
      }
      const sums before = sum_up(f.w);
      CHECK_EQ_INT(couple_split(f.w, c, FRAY_LOOSE), 1);
      const sums after = sum_up(f.w);
      CHECK(memcmp(&before, &after, sizeof before) == 0);
      yarn_check_tick(&k, &f);
      ++splits;
    }
    CHECK_EQ_INT(k.bad, 0);
    yarn_check_close(&k);
    fixture_close(&f);
  }
  figure("splits_that_keep_every_sum", splits, "", "all");
}

/* Of a flat sheet in the x-y plane, weft 0 at the top: along warp x along weft is +z. */
static void halves_lie_on_the_sides_of_the_weave(void) {
  fixture f;
  open_sheet(&f, "twill 2/1", "");
  const fray_sheet sheet = fray_view_sheet(f.w);
  const int32_t half = f.facts.thickness / 2;
  for (uint32_t c = 12; c < 132; ++c) {
    const uint32_t i = c % 12, j = c / 12;
    const int over = (int)(sheet.weave >> (j % sheet.weave_rows * 8 + i % sheet.weave_columns) & 1u);
    const int32_t z = f.w->z[fray_particle_at(f.w, c)];
    CHECK_EQ_INT(couple_split(f.w, c, FRAY_LOOSE), 1);
    const fray_particles p = fray_view_particles(f.w);
    CHECK_EQ_INT(p.z[fray_particle_of(f.w, c, FRAY_WARP)], z + (over ? half : -half));
    CHECK_EQ_INT(p.z[fray_particle_of(f.w, c, FRAY_WEFT)], z - (over ? half : -half));
    CHECK_EQ_INT(fray_couple_at(f.w, c), FRAY_LOOSE);
  }
  fixture_close(&f);
}

static void it_stops_where_no_particle_is_left(void) {
  fixture f;
  open_sheet(&f, "plain", "limits {\n spare_particles 3\n}\n");
  const uint64_t whole = world_hash(f.w);
  for (uint32_t c = 20; c < 23; ++c) CHECK_EQ_INT(couple_split(f.w, c, FRAY_LOOSE), 1);
  const uint64_t full = world_hash(f.w);
  CHECK(whole != full);
  CHECK_EQ_INT(couple_split(f.w, 30, FRAY_LOOSE), 0);
  CHECK(world_hash(f.w) == full);
  CHECK_EQ_INT(fray_view_particles(f.w).count, 135);
  fixture_close(&f);
}

/* Links and springs of a sheet where every other crossing has split: rows between light, whole and
 * held ends. Momentum, in half crossings, is what the bodies gave. */
static void rows_between_unequal_ends_keep_momentum(void) {
  uint64_t seed = 9;
  for (uint32_t trial = 0; trial < 40; ++trial) {
    fixture f;
    open_sheet(&f, "plain", "");
    shake(&f, &seed);
    for (uint32_t c = 12; c < 132; ++c)
      if (fixture_random(&seed) % 2 == 0) couple_split(f.w, c, FRAY_LOOSE);
    memset(f.w->motion, 0, f.w->capacity[POOL_BODIES] * sizeof *f.w->motion);
    const sums before = sum_up(f.w);
    if (trial % 2 == 0)
      strain_run(f.w);
    else
      springs_run(f.w);
    const sums after = sum_up(f.w);
    const int64_t *gave = f.w->motion[0].impulse;
    for (uint32_t n = 0; n < 3; ++n) {
      CHECK_EQ_INT(after.at[n] - before.at[n], trial % 2 == 0 ? gave[n] / 8 : 0);
      CHECK_EQ_INT(after.speed[n] - before.speed[n], trial % 2 == 0 ? 0 : gave[n] * 2);
      CHECK_EQ_INT(trial % 2 == 0 ? gave[n] % 8 : 0, 0);
    }
    fixture_close(&f);
  }
}

/* A light end goes twice as far as a whole one. */
static void a_light_end_takes_two_thirds(void) {
  fixture f;
  open_sheet(&f, "plain", "");
  const uint32_t c = 5 * 12 + 5; /* whole, and the next one split */
  couple_split(f.w, c + 1, FRAY_LOOSE);
  const uint32_t i = fray_particle_of(f.w, c, FRAY_WEFT);
  const uint32_t j = fray_particle_of(f.w, c + 1, FRAY_WEFT);
  for (uint32_t row = 0; row < f.w->capacity[POOL_ROWS]; ++row)
    if (!((f.w->row_i[row] == i && f.w->row_j[row] == j) ||
          (f.w->row_i[row] == j && f.w->row_j[row] == i)))
      world_kill_row(f.w, row);
  f.w->x[j] += 100000;
  const int32_t before[2] = {f.w->x[i], f.w->x[j]};
  strain_run(f.w);
  const int32_t moved_i = f.w->x[i] - before[0];
  const int32_t moved_j = f.w->x[j] - before[1];
  CHECK(moved_i > 1000);
  CHECK_EQ_INT(moved_j, -2 * moved_i);
  fixture_close(&f);
}

/* The kernels of this machine against the scalar one, over a sheet that is part yarn. */
static void wide_kernels_agree(void) {
  static const fray_kernel kernels[] = {FRAY_KERNEL_AVX2, FRAY_KERNEL_AVX512, FRAY_KERNEL_NEON};
  uint32_t compared = 0;
  for (uint32_t n = 0; n < sizeof kernels / sizeof kernels[0]; ++n) {
    fixture f, g;
    uint64_t seed = 77;
    open_sheet(&f, "twill 2/2", "");
    open_sheet(&g, "twill 2/2", "");
    if (cpu_has(kernels[n]) && fray_use(g.w, kernels[n])) {
      ++compared;
      for (uint32_t c = 12; c < 132; ++c)
        if (fixture_random(&seed) % 2 == 0) {
          couple_split(f.w, c, FRAY_LOOSE);
          couple_split(g.w, c, FRAY_LOOSE);
        }
      for (uint32_t tick = 0; tick < 200; ++tick)
        CHECK(fixture_tick(&f, &fixture_idle).hash == fixture_tick(&g, &fixture_idle).hash);
    }
    fixture_close(&f);
    fixture_close(&g);
  }
  printf("  %u kernels compared\n", compared);
}

int main(void) {
  TEST(a_split_keeps_its_sums);
  TEST(halves_lie_on_the_sides_of_the_weave);
  TEST(it_stops_where_no_particle_is_left);
  TEST(rows_between_unequal_ends_keep_momentum);
  TEST(a_light_end_takes_two_thirds);
  TEST(wide_kernels_agree);
  return test_end();
}
