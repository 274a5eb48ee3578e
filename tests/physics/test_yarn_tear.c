/* SPDX-License-Identifier: Apache-2.0 */
/* Sheets with yarns, torn: what yarn_check.h walks after every tick, work within its limits, pools of any
 * size, saving in the middle of a tear, and rest where nothing pulls. */
#include "tests/lib/test.h"

#include "tests/lib/yarn_check.h"

static void open_strip(fixture *f, const char *sheet, const char *limits) {
  fixture_print(f,
                "scene strip\nrate 1000 Hz\nsubsteps 4\nseed 3\n"
                "limits {\n tears_per_tick 4\n %s\n}\n"
                "woven {\n warps 16\n wefts 12\n spacing 12 /cm\n tear 5 10 %%\n drag 2 /s\n"
                " slip_friction 0.3\n crossing_friction 0.2 mN\n %s\n}\n"
                "capsule left {\n radius 0.05 cm\n length 1.1 cm\n rotate 90 deg about z\n"
                " at -0.625 0 0 cm\n attach_within 0.01 cm\n}\n"
                "capsule right {\n radius 0.05 cm\n length 1.1 cm\n rotate 90 deg about z\n"
                " at 0.625 0 0 cm\n move path { 0 s 0.625 0 0 cm 1 s 2.625 0 0 cm }\n"
                " attach_within 0.01 cm\n}\n",
                limits, sheet);
}

typedef struct {
  fray_output last;
  uint32_t splits, slips, splits_most;
  uint16_t faults;
} strip_run;

static strip_run run_strip(fixture *f, uint32_t ticks) {
  strip_run r = {0};
  CLOSED_BY(yarn_check_close) yarn_check k = {0};
  const fray_work most = fray_work_bound(f->w);
  yarn_check_open(&k, f);
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    r.last = fixture_tick(f, &fixture_idle);
    r.splits += r.last.work.splits;
    r.slips += r.last.work.slips;
    r.faults |= r.last.faults;
    if (r.last.work.splits > r.splits_most) r.splits_most = r.last.work.splits;
    CHECK(fixture_within_bound(&r.last.work, &most));
    yarn_check_tick(&k, f);
  }
  CHECK_EQ_INT(k.bad, 0);
  return r;
}

static void every_weave_tears_by_the_rules(void) {
  static const char *const sheets[] = {
      "yarns on",
      "yarns on\n weave twill 2/1",
      "yarns on\n weave twill 2/2\n disconnect_by particles",
      "yarns on\n weave satin 5",
      "yarns on\n weave matrix {\n 11\n 10\n }\n split_strain 2 3 %",
      "yarns all",
      "yarns all\n weave twill 2/1"};
  for (uint32_t n = 0; n < sizeof sheets / sizeof sheets[0]; ++n) {
    fixture_scoped f = {0};
    open_strip(&f, sheets[n], "");
    const strip_run r = run_strip(&f, 250);
    printf("  sheet %u: %3u cuts %3u splits, %3u loose, %3u apart\n", n, r.last.tears_total,
           r.splits, r.last.crossings_loose, r.last.crossings_disconnected);
    CHECK(r.last.tears_total > 5);
    CHECK(r.splits > 30);
    CHECK(r.last.crossings_disconnected > 0);
    CHECK((r.faults & FRAY_FAULT_PARTICLES_FULL) == 0);
    if (strncmp(sheets[n], "yarns all", 9) != 0) CHECK_EQ_INT(r.last.crossings_connected, 0);
  }
}

static void without_yarns_nothing_splits(void) {
  fixture_scoped f = {0};
  open_strip(&f, "yarns off", "");
  for (uint32_t tick = 0; tick < 250; ++tick) {
    const fray_output out = fixture_tick(&f, &fixture_idle);
    CHECK(out.work.splits == 0 && out.work.slips == 0 && out.work.transitions == 0);
    CHECK(out.crossings_loose == 0 && out.crossings_disconnected == 0);
  }
  CHECK_EQ_INT(fray_view_particles(f.w).count, 16 * 12);
  CHECK_EQ_INT(fray_get_info(f.w).splits_max, 0);
}

/* Every size from none on: each run ends, says that the pool was full, and breaks no rule. */
static void pools_of_any_size(void) {
  fixture f;
  open_strip(&f, "yarns on", "");
  const uint32_t needed = run_strip(&f, 250).splits;
  const uint64_t free_hash = fray_hash(f.w);
  fixture_close(&f);
  figure("spares_needed", needed, "", "printed");
  for (uint32_t size = 0; size <= needed + 1; size = size < 8 || size >= needed - 1 ? size + 1 : size * 2) {
    char limits[64];
    if (size > 8 && size < needed && size * 2 >= needed) size = needed - 1;
    snprintf(limits, sizeof limits, "spare_particles %u", size);
    open_strip(&f, "yarns on", limits);
    const strip_run r = run_strip(&f, 250);
    CHECK(r.splits <= size);
    CHECK_EQ_INT(r.last.tick, 249);
    CHECK_EQ_INT((r.faults & FRAY_FAULT_PARTICLES_FULL) != 0, size < needed);
    if (size == 0) CHECK_EQ_INT(r.last.tears_total, 0);
    if (size >= needed) CHECK(fray_hash(f.w) == free_hash);
    fixture_close(&f);
  }
}

/* At most as many splits in a tick as the scene says; the others wait, and say so. */
static void splits_wait_their_turn(void) {
  static const uint32_t caps[] = {1, 2, 5, 4096};
  for (uint32_t n = 0; n < 4; ++n) {
    fixture_scoped f = {0};
    char limits[64];
    snprintf(limits, sizeof limits, "splits_per_tick %u", caps[n]);
    open_strip(&f, "yarns on", limits);
    const strip_run r = run_strip(&f, 250);
    CHECK(r.splits_most <= caps[n]);
    CHECK_EQ_INT((r.faults & FRAY_FAULT_SPLIT_BUDGET) != 0, caps[n] < 100);
    CHECK(r.splits > 30);
  }
}

/* Saved at any moment of a tear and opened again: the same from there on. */
static void saved_in_the_middle(void) {
  fixture_scoped f = {0};
  uint32_t saves = 0;
  open_strip(&f, "yarns on\n weave twill 2/1", "splits_per_tick 1");
  for (uint32_t tick = 0; tick < 200; ++tick) {
    const fray_output out = fixture_tick(&f, &fixture_idle);
    if (out.splits_waiting == 0 && tick % 20 != 0) continue;
    fixture one, other;
    fixture_copy(&one, &f);
    fixture_copy(&other, &one);
    ++saves;
    CHECK(fray_hash(one.w) == out.hash);
    CHECK(one.image_bytes == other.image_bytes &&
          memcmp(one.image, other.image, one.image_bytes) == 0);
    fixture_close(&other);
    fixture_copy(&other, &f);
    for (uint32_t n = 0; n < 10; ++n)
      CHECK(fixture_tick(&one, &fixture_idle).hash == fixture_tick(&other, &fixture_idle).hash);
    /* the one that goes on was opened from its save */
    fixture_close(&one);
    fixture_close(&f);
    fixture_copy(&f, &other);
    fixture_close(&other);
  }
  CHECK(saves > 20);
}

/* In g cm2/s2, of light and whole particles. */
static double kinetic(const fixture *f) {
  const fray_world *w = f->w;
  double total = 0;
  for (uint32_t p = (uint32_t)w->params->attached; p < w->p.count; ++p) {
    const double v2 = (double)w->p.vx[p] * w->p.vx[p] + (double)w->p.vy[p] * w->p.vy[p] +
                      (double)w->p.vz[p] * w->p.vz[p];
    total += v2 * (particle_is_half(w, p) ? 0.25 : 0.5);
  }
  return total * fixture_mass_g(f) * fixture_speed(f) * fixture_speed(f);
}

/* A sheet that hangs at rest has a patch of it split: it comes to rest again, and nothing parts. */
static void a_split_patch_comes_to_rest(void) {
  fixture_scoped f = {0};
  fixture_print(&f, "scene rest\nrate 1000 Hz\nsubsteps 8\nseed 5\nsettle 0.3 s\nwoven {\n warps 16\n"
                    " wefts 16\n spacing 12 /cm\n yarns on\n slip_friction 0.3\n crossing_friction 0.1 mN\n"
                    " drag 0.5 /s\n}\npin row top\n");
  const double before = kinetic(&f);
  for (uint32_t c = 0; c < 256; ++c)
    if (c % 16 > 3 && c % 16 < 12 && c / 16 > 3 && c / 16 < 12) crossing_split(f.w, c, FRAY_LOOSE);
  double most = 0;
  double last = 0;
  fray_output out;
  memset(&out, 0, sizeof out);
  for (uint32_t tick = 0; tick < 1000; ++tick) {
    out = fixture_tick(&f, &fixture_idle);
    const double now = kinetic(&f);
    if (now > most) most = now;
    if (tick >= 900 && now > last) last = now;
  }
  /* of 0.44 g: 0.1 cm/s is 0.002 erg */
  figure("patch_kinetic_before", before, "erg", "printed");
  figure("patch_kinetic_most", most, "erg", "below 1");
  figure("patch_kinetic_after_0.9_s", last, "erg", "below 0.02");
  CHECK(most < 1);
  CHECK(last < 0.02);
  CHECK_EQ_INT(out.crossings_loose, 64);
  CHECK_EQ_INT(out.crossings_disconnected, 0);
  CHECK_EQ_INT(out.tears_total, 0);
}

/* A slit from the sheet's edge inwards: cut before tick 0, by the rules of a tear, and torn on from its end. */
static void a_slit_is_a_tear_from_the_start(void) {
  static const char *const yarns[] = {"off", "on", "all"};
  for (uint32_t n = 0; n < 3; ++n) {
    fixture_scoped f = {0};
    CLOSED_BY(yarn_check_close) yarn_check k = {0};
    fray_output out;
    fixture_print(&f,
                  "scene slit\nrate 1000 Hz\nsubsteps 8\nseed 3\nsettle 0.05 s\nslit warp 7 0 4\n"
                  "slit weft 8 0 2\npin row top by right\npin column left\n"
                  "woven {\n warps 16\n wefts 12\n spacing 12 /cm\n drag 20 /s\n yarns %s\n}\n"
                  "sphere right {\n radius 0.1 cm\n move path { 0 s 2 0 0 cm 1 s 4 1 0 cm }\n}\n",
                  yarns[n]);
    uint32_t dead = 0;
    for (uint32_t row = 0; row < f.facts.springs[FRAY_STRUCTURAL]; ++row)
      dead += !fray_view_spring(f.w, FRAY_STRUCTURAL, row).alive;
    CHECK_EQ_INT(dead, 5 + 3);
    CHECK_EQ_INT(fray_view_particles(f.w).attached, 16 + 11);
    /* beside the slits: 2 x 4 and 2 x 2 crossings that nothing holds */
    if (n == 1) CHECK_EQ_INT(fray_view_particles(f.w).count, 16 * 12 + 12);
    if (n != 0) yarn_check_open(&k, &f);
    for (uint32_t tick = 0; tick < 150; ++tick) {
      out = fixture_tick(&f, &fixture_idle);
      if (n != 0) yarn_check_tick(&k, &f);
    }
    CHECK(out.tears_total > 0);
    CHECK_EQ_INT(k.bad, 0);
  }
}

/* Two seconds after its bars have stopped, in thin air: ways that particles went in a tick, of the last 0.2 s. */
static void a_torn_strip_comes_to_rest(void) {
  enum { STOPPED = 1000, TICKS = 3000, LAST = 200 };
  fixture_scoped f = {0};
  double sum = 0;
  double most = 0;
  uint64_t count = 0;
  fixture_file(&f, "tests/scenes/strip.scene", "drag 40 /s", "drag 4 /s", NULL);
  const double mm = fixture_lu_cm(&f) * 0x1p-24 * 10;
  vec3 *before = malloc(f.w->capacity[POOL_PARTICLES] * sizeof *before);
  if (before == NULL) fixture_give_up("test", "out of memory");
  fray_output out = {0};
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    for (uint32_t p = 0; p < f.w->p.count; ++p) before[p] = world_position(f.w, p);
    const uint32_t known = f.w->p.count;
    out = fixture_tick(&f, &fixture_idle);
    for (uint32_t p = particles_attached(f.w); p < known && tick >= TICKS - LAST; ++p) {
      const double way = sqrt((double)vec_squared(vec_sub(world_position(f.w, p), before[p])));
      const double speed = way * mm * f.facts.rate_hz;
      sum += speed * speed;
      most = fmax(most, speed);
      ++count;
    }
  }
  free(before);
  figure("torn_strip_rests_at_rms", sqrt(sum / (double)count), "mm/s", "1");
  figure("torn_strip_rests_at_worst", most, "mm/s", "10");
  CHECK(out.tears_total > 20 && out.crossings_loose > 50);
  CHECK(sqrt(sum / (double)count) < 1 && most < 10);
}

int main(void) {
  TEST(every_weave_tears_by_the_rules);
  TEST(without_yarns_nothing_splits);
  TEST(pools_of_any_size);
  TEST(splits_wait_their_turn);
  TEST(saved_in_the_middle);
  TEST(a_split_patch_comes_to_rest);
  TEST(a_slit_is_a_tear_from_the_start);
  TEST(a_torn_strip_comes_to_rest);
  return test_end();
}
