/* SPDX-License-Identifier: Apache-2.0 */
/* The scenes of tests/scenes/strength, as they stand: what each says of the force that draws it; and
 * that a run is the same under every kernel, and when it is saved and opened again on the way. */
#include "tests/lib/test.h"
#include "tests/lib/simd_kernels.h"
#include "tests/lib/world_fixture.h"
#include "tests/lib/yarn_check.h"

enum { TICKS = 1500, SAVED_EVERY = 97, CUTS = 64 };

typedef struct {
  double peak;          /* N, of the body that is drawn */
  double opening_there; /* cm */
  uint32_t cuts;
  uint32_t cut_weft[CUTS]; /* the wefts that were cut, in their order: from the top */
  uint32_t last_force; /* the last tick with a tenth of the peak or more */
} pull;

static double way_of(const fixture *f, uint32_t b, const fray_body *start) {
  const fray_body now = fray_view_body(f->w, b);
  double square = 0;
  for (uint32_t n = 0; n < 3; ++n) {
    const double d = ((double)now.position[n] - start->position[n]) * fixture_lu_cm(f) * 0x1p-24;
    square += d * d;
  }
  return sqrt(square);
}

static double force_on(const fixture *f, uint32_t b, uint32_t axis) {
  const double speed = (double)fray_view_body(f->w, b).impulse[axis] * fixture_speed(f);
  return fabs(speed) * fixture_mass_g(f) * f->facts.rate_hz * 1e-5;
}

static void note_cuts(const fixture *f, uint8_t *dead, pull *p) {
  const uint32_t warps = fray_view_weave(f->w).warps;
  for (uint32_t home = 0; home < (uint32_t)f->w->params->links; ++home) {
    if (dead[home] || f->w->woven.spring_kind[f->w->woven.spring_of[home]] != SPRING_DEAD) continue;
    uint32_t a, b;
    yarn_grid_ends(world_yarn_grid(f->w), home, &a, &b);
    dead[home] = 1;
    if (p->cuts < CUTS) p->cut_weft[p->cuts] = a / warps;
    ++p->cuts;
  }
}

static void compare_tick(const fray_output *one, const fray_output *two, uint32_t *different) {
  *different += one->hash != two->hash || memcmp(one->force, two->force, sizeof one->force) != 0 ||
                memcmp(&one->work, &two->work, sizeof one->work) != 0;
}

/* Opens what it saves, every so often, also while it tears. */
static void save_and_open(fixture *f) {
  fixture next;
  fixture_copy(&next, f);
  fixture_close(f);
  *f = next;
}

/* The body that is drawn, and along which axis. */
static pull run_scene(const char *path, uint32_t drawn, uint32_t axis) {
  fixture plain, saved, other[SIMD_KERNELS];
  fray_kernel kernels[SIMD_KERNELS];
  const uint32_t count = simd_kernels(kernels);
  uint32_t different[SIMD_KERNELS + 1] = {0};
  uint32_t over = 0;
  static double force[TICKS];
  static uint8_t dead[4096];
  pull p = {0};
  CLOSED_BY(yarn_check_close) yarn_check k = {0};
  memset(dead, 0, sizeof dead);
  fixture_file(&plain, path, NULL);
  fixture_copy(&saved, &plain);
  for (uint32_t n = 0; n < count; ++n) {
    fixture_copy(&other[n], &plain);
    CHECK(fray_set_kernel(other[n].w, kernels[n]));
  }
  const int yarns = world_has_yarns(plain.w);
  const fray_body start = fray_view_body(plain.w, drawn);
  const fray_work most = fray_work_bound(plain.w);
  if (yarns) yarn_check_open(&k, &plain);
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    const fray_output out = fixture_tick(&plain, &fixture_idle);
    const fray_output again = fixture_tick(&saved, &fixture_idle);
    compare_tick(&out, &again, &different[count]);
    for (uint32_t n = 0; n < count; ++n) {
      const fray_output wide = fixture_tick(&other[n], &fixture_idle);
      compare_tick(&out, &wide, &different[n]);
    }
    if (yarns) yarn_check_tick(&k, &plain);
    over += !fixture_within_bound(&out.work, &most);
    note_cuts(&plain, dead, &p);
    force[tick] = force_on(&plain, drawn, axis);
    if (force[tick] > p.peak) p.opening_there = way_of(&plain, drawn, &start);
    p.peak = fmax(p.peak, force[tick]);
    if (tick % SAVED_EVERY == SAVED_EVERY - 1 || out.work.tears != 0) save_and_open(&saved);
  }
  for (uint32_t tick = 0; tick < TICKS; ++tick)
    if (force[tick] >= p.peak / 10) p.last_force = tick;
  for (uint32_t n = 0; n < count; ++n) {
    printf("figure %s %s ticks that differ from scalar %u (asked: 0)\n", path,
           simd_kernel_names[kernels[n]], different[n]);
    CHECK_EQ_INT(different[n], 0);
    fixture_close(&other[n]);
  }
  printf("figure %s ticks that differ after saves %u (asked: 0)\n", path, different[count]);
  CHECK_EQ_INT(different[count], 0);
  CHECK_EQ_INT(over, 0);
  CHECK_EQ_INT(plain.w->state->faults, 0);
  CHECK_EQ_INT(k.bad, 0);
  fixture_close(&plain);
  fixture_close(&saved);
  return p;
}

/* Both warps at 0.5 N * 5 to 5.2 %. */
static void single_yarn(void) {
  const pull p = run_scene("tests/scenes/strength/single_yarn.scene", 0, 1);
  figure("single_yarn_peak", 1000 * p.peak, "mN", "50 to 52 within 1 %");
  CHECK(p.peak > 0.0495 && p.peak < 0.0525);
  CHECK(p.cuts >= 2);
}

/* Twelve warps at 0.5 N * 5 %: splits keep their tension, the first that tears does not. */
static void strip_tensile(void) {
  const pull p = run_scene("tests/scenes/strength/strip_tensile.scene", 0, 1);
  figure("strip_peak", 1000 * p.peak, "mN", "300 within 2 %: the first warps tear");
  CHECK(fabs(p.peak / 0.3 - 1) < 0.02);
  CHECK(p.cuts >= 12);
}

static double mean_weft(const pull *p, uint32_t first, uint32_t end) {
  double sum = 0;
  for (uint32_t n = first; n < end; ++n) sum += p->cut_weft[n];
  return sum / (end - first);
}

static void tongue_tear(void) {
  const pull p = run_scene("tests/scenes/strength/tongue_tear.scene", 0, 2);
  const uint32_t cuts = p.cuts < CUTS ? p.cuts : (uint32_t)CUTS;
  figure("tongue_peak", 1000 * p.peak, "mN", "printed");
  figure("tongue_opening_at_peak", 2 * p.opening_there, "cm", "printed");
  CHECK(cuts >= 6); /* about as many wefts are drawn by more than 5 % between the bars */
  const double early = mean_weft(&p, 0, cuts / 4);
  const double late = mean_weft(&p, cuts - cuts / 4, cuts);
  figure("tongue_first_quarter_of_cuts", early, "wefts_from_the_top", "the tear runs down");
  figure("tongue_last_quarter_of_cuts", late, "wefts_from_the_top", "2 below that");
  CHECK(late > early + 2);
}

static void pull_out(void) {
  const pull p = run_scene("tests/scenes/strength/pull_out.scene", 0, 1);
  figure("pull_out_peak", 1000 * p.peak, "mN", "printed");
  figure("pull_out_free_after", p.last_force * 0.3 / 2000, "cm", "it is drawn to the end");
  CHECK_EQ_INT(p.cuts, 0);
  CHECK(p.peak > 22 * 0.3e-3 && p.last_force == TICKS - 1);
}

int main(void) {
  TEST(single_yarn);
  TEST(strip_tensile);
  TEST(tongue_tear);
  TEST(pull_out);
  return test_end();
}
