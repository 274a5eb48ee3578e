/* SPDX-License-Identifier: Apache-2.0 */
/* A sheet with yarns, pulled apart and hit by a ball, with pools of every size from none to what it needs,
 * each alone and all together: every run ends, says which pool was full, keeps to its bound, and breaks no
 * rule of yarn_check.h in any tick. With an argument every size; without, sizes that grow. */
#include "tests/lib/test.h"

#include "tests/lib/yarn_check.h"

enum { TICKS = 200 };
typedef enum { SPARES, CONTACTS, CUTS, SPLITS, SIZED } sized;
static const char *const keys[SIZED] = {"spare_particles", "contacts", "tears_per_tick",
                                        "splits_per_tick"};
static const uint16_t flags[SIZED] = {FRAY_FAULT_PARTICLES_FULL, FRAY_FAULT_CONTACTS_FULL,
                                      FRAY_FAULT_BREAK_BUDGET, FRAY_FAULT_SPLIT_BUDGET};
static const uint32_t plenty[SIZED] = {16 * 12, 2000, 64, 4096};
static int every_size;

typedef struct {
  uint32_t most[SIZED]; /* used: particles, contacts; in a tick: cuts, splits */
  uint32_t cuts, splits;
  uint16_t faults;
  uint64_t hash;
} run;

static void open_sheet(fixture *f, const uint32_t sizes[SIZED]) {
  char limits[160];
  int at = 0;
  for (int n = 0; n < SIZED; ++n)
    at += snprintf(limits + at, sizeof limits - (size_t)at, " %s %u\n", keys[n], sizes[n]);
  fixture_print(f,
                "scene pools\nrate 1000 Hz\nsubsteps 4\nseed 3\nlimits {\n%s}\n"
                "woven {\n warps 16\n wefts 12\n spacing 12 /cm\n tear 5 10 %%\n drag 2 /s\n"
                " yarns on\n slip_friction 0.3\n crossing_friction 0.2 mN\n}\n"
                "capsule left {\n radius 0.05 cm\n length 1.1 cm\n rotate 90 deg about z\n"
                " at -0.625 0 0 cm\n attach_within 0.01 cm\n}\n"
                "capsule right {\n radius 0.05 cm\n length 1.1 cm\n rotate 90 deg about z\n"
                " at 0.625 0 0 cm\n move path { 0 s 0.625 0 0 cm 1 s 2.625 0 0 cm }\n"
                " attach_within 0.01 cm\n}\n"
                "sphere b {\n radius 0.2 cm\n at 0.1 0 0.6 cm\n move free\n mass 2 g\n"
                " velocity 0 20 -60 cm/s\n}\nplane ground {\n at 0 -0.7 0 cm\n}\n",
                limits);
}

static run run_sheet(const uint32_t sizes[SIZED]) {
  fixture_scoped f = {0};
  CLOSED_BY(yarn_check_close) yarn_check k = {0};
  run r = {0};
  open_sheet(&f, sizes);
  yarn_check_open(&k, &f);
  const fray_work most = fray_work_bound(f.w);
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    const fray_output out = fixture_tick(&f, &fixture_idle);
    const uint32_t used[SIZED] = {f.w->p.count - 16u * 12u, f.w->contact.count, out.work.tears,
                                  out.work.splits};
    CHECK_EQ_INT(out.tick, tick);
    CHECK(fixture_within_bound(&out.work, &most));
    for (int n = 0; n < SIZED; ++n) {
      CHECK(used[n] <= sizes[n]);
      if (used[n] > r.most[n]) r.most[n] = used[n];
    }
    yarn_check_tick(&k, &f);
    r.cuts = out.tears_total;
    r.splits += out.work.splits;
    r.faults |= out.faults;
    r.hash = out.hash;
  }
  CHECK_EQ_INT(k.bad, 0);
  /* what is left is a world that opens */
  fixture_scoped copy = {0};
  fixture_copy(&copy, &f);
  CHECK(fray_hash(copy.w) == r.hash);
  return r;
}

/* Grows by a quarter, and looks at the edge once more. */
static uint32_t next_size(uint32_t size, uint32_t needed) {
  if (every_size || size < 4 || size + 2 >= needed) return size + 1;
  const uint32_t grown = size + size / 4 + 1;
  return grown + 1 < needed ? grown : needed - 1;
}

/* Neither cuts nor splits have a pool of no size: that is `tear off`, `yarns off`. */
static uint32_t least_size(int pool) { return pool == CUTS || pool == SPLITS; }

static void each_pool_alone(void) {
  const run enough = run_sheet(plenty);
  CHECK_EQ_INT(enough.faults, 0);
  CHECK(enough.cuts > 5 && enough.splits > 30);
  for (int pool = 0; pool < SIZED; ++pool) {
    const uint32_t needed = enough.most[pool];
    uint32_t runs = 0;
    for (uint32_t size = least_size(pool); size <= needed; size = next_size(size, needed), ++runs) {
      uint32_t sizes[SIZED];
      memcpy(sizes, plenty, sizeof sizes);
      sizes[pool] = size;
      const run r = run_sheet(sizes);
      CHECK_EQ_INT((r.faults & flags[pool]) != 0, size < needed);
      if (size == needed) CHECK(r.faults == 0 && r.hash == enough.hash);
      if (pool == SPARES && size == 0) CHECK(r.cuts == 0 && r.splits == 0);
    }
    printf("figure pools_%s needed %u, sizes tried %u (asked: each says so when full)\n", keys[pool], needed,
           runs);
    CHECK(needed > 2);
  }
}

static void all_together(void) {
  static const uint32_t small[] = {0, 1, 2, 7, 30};
  const uint32_t count = sizeof small / sizeof small[0];
  uint32_t runs = 0;
  for (uint32_t n = 0; n < count * count * count * count; ++n) {
    const uint32_t digit[SIZED] = {n % count, n / count % count, n / count / count % count,
                                   n / count / count / count};
    const int alike = digit[0] == digit[1] && digit[1] == digit[2] && digit[2] == digit[3];
    if (!every_size && !alike) continue;
    uint32_t sizes[SIZED];
    for (int pool = 0; pool < SIZED; ++pool)
      sizes[pool] = small[digit[pool]] > 0 ? small[digit[pool]] : least_size(pool);
    const run r = run_sheet(sizes);
    CHECK((r.faults & FRAY_FAULT_PARTICLES_FULL) != 0);
    ++runs;
  }
  printf("figure pools_together %u sizes (asked: the run ends)\n", runs);
}

int main(int argc, char **argv) {
  (void)argv;
  every_size = argc > 1;
  TEST(each_pool_alone);
  TEST(all_together);
  return test_end();
}
