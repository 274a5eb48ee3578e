/* SPDX-License-Identifier: Apache-2.0 */
/* The energy ledger: it closes in every kind of scene, agrees with sums in double precision, and changes no bit
 * of a world. */
#include "rt/base/wide.h"
#include "rt/state/crossing.h"
#include "tests/lib/world_fixture.h"

static double sum_of(const int64_t *row, uint32_t count) {
  double sum = 0;
  for (uint32_t n = 0; n < count; ++n) sum += (double)row[n];
  return sum;
}
static double total_of(const fray_energy_account *a) { return sum_of(a->stored, FRAY_ENERGY_STORES); }
static double supplied_of(const fray_energy_account *a) { return sum_of(a->supplied, FRAY_ENERGY_SUPPLIES); }
static double made_of(const fray_energy_account *a) { return sum_of(a->made, FRAY_ENERGY_STAGES); }
static double lost_of(const fray_energy_account *a) { return sum_of(a->lost, FRAY_ENERGY_STAGES); }

/* Joules of a unit. */
static double unit_of(const fixture *f) {
  const double step = (double)f->facts.lu_um * f->facts.rate_hz * f->facts.substeps;
  return 0x1p-40 * f->facts.particle_mass_ng * 1e-24 * step * step;
}

static double mass_of(const fray_world *w, uint32_t p) {
  if (world_has_membrane(w)) return (double)w->trimesh.mass[p] / w->membrane.constants->mass_unit;
  return world_has_yarns(w) && particle_is_half(w, p) ? 0.5 : 1;
}

/* m v^2 / 2 and - m g.x in joules, by the views alone. */
typedef struct {
  double kinetic, potential;
} motion_energy;
static motion_energy energy_of(const fixture *f) {
  const fray_particles v = fray_view_particles(f->w);
  const fray_info k = f->facts;
  const double lu = k.lu_um * 1e-6;
  const double rate = (double)k.rate_hz * k.substeps;
  motion_energy e = {0, 0};
  for (uint32_t p = v.attached; p < v.count; ++p) {
    const double mass = mass_of(f->w, p) * k.particle_mass_ng * 1e-12;
    const double speed2 = (double)v.vx[p] * v.vx[p] + (double)v.vy[p] * v.vy[p] + (double)v.vz[p] * v.vz[p];
    const double at[3] = {v.x[p], v.y[p], v.z[p]};
    e.kinetic += mass * speed2 * 0x1p-57 * lu * lu * rate * rate;
    for (uint32_t n = 0; n < 3; ++n)
      e.potential -= mass * (k.gravity[n] + k.gravity_rest[n] * 0x1p-32) * 0x1p-28 * lu * rate * rate * at[n] *
                     0x1p-24 * lu;
  }
  return e;
}

/* ---- arithmetic ---- */

static void wide_sums_and_products_are_exact(void) {
#ifdef __SIZEOF_INT128__
  __extension__ typedef __int128 whole128;
  uint64_t seed = 1;
  for (uint32_t n = 0; n < 100000 / TEST_FEWER; ++n) {
    const int64_t a = (int64_t)splitmix64(&seed) >> splitmix64(&seed) % 62;
    const int64_t b = (int64_t)splitmix64(&seed) >> splitmix64(&seed) % 62;
    const uint32_t by = (uint32_t)(splitmix64(&seed) >> 33) + 1u;
    const whole128 product = (whole128)a * b;
    const wide_number whole = wide_product(a, b, 64);
    CHECK_EQ_INT(whole.whole, (int64_t)(product >> 64));
    CHECK_EQ_INT(whole.part, (uint64_t)product);
    const wide_number down = wide_product(a, b, 90);
    CHECK_EQ_INT(down.whole, (int64_t)(product >> 90));
    CHECK_EQ_INT(down.part, (uint64_t)(product >> 26));
    const wide_number over = wide_over(whole, by);
    CHECK_EQ_INT(over.whole, (int64_t)(product / by >> 64));
    CHECK_EQ_INT(over.part, (uint64_t)(product / by));
    const wide_number back = wide_add(wide_sub(whole, over), over);
    CHECK(back.whole == whole.whole && back.part == whole.part);
  }
#endif
  const wide_number half = {-1, (uint64_t)1 << 63};
  CHECK_EQ_INT(wide_rounded(half, 1), -1);
  CHECK_EQ_INT(wide_rounded(wide_of(INT64_MAX, 1), 40), INT64_MAX);
}

/* ---- every kind of scene ---- */

static const struct {
  const char *file;
  uint32_t ticks;
} scenes[] = {{"tests/scenes/small.scene", 100},
              {"tests/determinism/bodies.scene", 60},
              {"tests/determinism/frayed.scene", 100},
              {"tests/determinism/allyarn.scene", 40},
              {"tests/determinism/yarn_collision.scene", 40},
              {"tests/determinism/stretched.scene", 60},
              {"tests/determinism/meshes.scene", 60},
              {"tests/determinism/triangle_collision.scene", 60},
              {"tests/determinism/membrane_tear.scene", 60},
              {"tests/determinism/blade_cut.scene", 60},
              {"tests/determinism/contact_triangles.scene", 60},
              {"tests/scenes/thrown_ball.scene", 40},
              {"tests/scenes/strip.scene", 30},
              {"tests/scenes/flag.scene", 100}};

/* The hashes and the counted work of the same world that is not watched; rows that add up to the change of the
 * total, tick by tick; and motion and height as the views have them, to a hundred-thousandth of either. */
static void closes_in(const char *file, uint32_t ticks) {
  fixture_scoped watched = {0};
  fixture_scoped plain = {0};
  fixture_file(&watched, file, NULL);
  fixture_file(&plain, file, NULL);
  fray_energy_watch(watched.w);
  const double unit = unit_of(&watched);
  double most_open = 0;
  double most_off = 0;
  for (uint32_t tick = 0; tick < ticks / TEST_FEWER; ++tick) {
    const fray_output a = fixture_tick(&watched, &fixture_idle);
    const fray_output b = fixture_tick(&plain, &fixture_idle);
    const fray_energy_account k = fray_energy(watched.w);
    const motion_energy e = energy_of(&watched);
    if (a.hash != b.hash || memcmp(&a.work, &b.work, sizeof a.work) != 0) {
      printf("%s: tick %u is another one where it is watched\n", file, tick);
      CHECK(0);
      return;
    }
    const double gained = supplied_of(&k) + made_of(&k) - lost_of(&k);
    const double motion = (double)wide_rounded(watched.w->energy.last.motion, 40) * unit;
    most_open = fmax(most_open, fabs(total_of(&k) - (double)k.begun - gained));
    most_off = fmax(most_off, (fabs(motion - e.kinetic) - unit) / (e.kinetic + unit));
    CHECK(k.ticks == tick + 1u && k.fastest_tick <= tick);
  }
  if (most_open > FRAY_ENERGY_ROUNDING || most_off > 1e-5)
    printf("%s: open by %.3g units; motion off by %.3g of it\n", file, most_open, most_off);
  CHECK(most_open <= FRAY_ENERGY_ROUNDING);
  CHECK(most_off <= 1e-5);
}

static void closes_in_every_kind_of_scene(void) {
  for (uint32_t n = 0; n < sizeof scenes / sizeof scenes[0]; ++n) closes_in(scenes[n].file, scenes[n].ticks);
}

/* ---- motions with a known account ---- */

static const char *const falling_woven =
    "scene fall\nrate 1000 Hz\nsubsteps 4\nwoven {\n warps 8\n wefts 8\n spacing 12 /cm\n tear off\n drag 0 /s\n}\n";
static const char *const falling_membrane =
    "scene fall\nrate 1000 Hz\nmembrane {\n columns 4\n rows 4\n cell 1 cm\n material denim\n drag 0 /s\n}\n";

/* Nothing but gravity: the total stays, to a velocity step times momentum for the fraction of g that is left
 * over (README of rt/energy). */
static void falls(const char *text) {
  fixture_scoped f = {0};
  fixture_text(&f, text);
  fray_energy_watch(f.w);
  for (uint32_t tick = 0; tick < 300; ++tick) (void)fixture_tick(&f, &fixture_idle);
  const fray_energy_account a = fray_energy(f.w);
  const motion_energy e = energy_of(&f);
  const double unit = unit_of(&f);
  const double lu_s = f.facts.lu_um * 1e-6 * f.facts.rate_hz * f.facts.substeps;
  double momentum = 0;
  for (uint32_t p = 0; p < f.w->p.count; ++p) momentum += mass_of(f.w, p) * f.facts.particle_mass_ng * 1e-12;
  momentum *= sqrt(2 * e.kinetic / momentum);
  CHECK(fabs((double)a.gravity * unit - e.kinetic) < 1e-3 * e.kinetic);
  const double net = fabs(made_of(&a) - lost_of(&a)) * unit;
  printf("figure free_fall_open %.3g of the kinetic energy\n", net / e.kinetic);
  CHECK(e.kinetic > 0);
  CHECK(net <= 2 * momentum * 0x1p-28 * lu_s + FRAY_ENERGY_ROUNDING * unit);
}
static void free_fall_keeps_the_total(void) {
  falls(falling_woven);
  falls(falling_membrane);
}

/* A cloth that lies flat and is held along one side swings down: without drag, wind and contact only its steps
 * can make or lose. The ledger has the polynomials that stages have for the forces of yarns and springs. What goes
 * taut within a step loses k a b / 2, for a before and b behind its rest length, and gets it back when it goes
 * slack as fast: damped cloth goes slack slower, so it may lose 1 %. A membrane's energy is that of its steps to
 * their rounding. */
static void swings(const char *name, const char *text, double most, double most_lost) {
  fixture_scoped f = {0};
  fixture_text(&f, text);
  fray_energy_watch(f.w);
  double turned = 0;
  double made = 0;
  double lost = 0;
  for (uint32_t tick = 0; tick < 400 / TEST_FEWER; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    const fray_energy_account a = fray_energy(f.w);
    turned = fmax(turned, fabs((double)a.gravity));
    const double net = (double)a.made[FRAY_ENERGY_STEPS] - (double)a.lost[FRAY_ENERGY_STEPS];
    made = fmax(made, net);
    lost = fmax(lost, -net);
  }
  printf("figure %s_steps_made %.3g of the energy turned over (asked: at most %g)\n", name, made / turned, most);
  printf("figure %s_steps_lost %.3g of the energy turned over (asked: at most %g)\n", name, lost / turned, most_lost);
  CHECK(turned > 0);
  CHECK(made <= most * turned);
  CHECK(lost <= most_lost * turned);
}
static void springs_keep_the_total(void) {
  swings("yarns",
         "scene swing\nrate 1000 Hz\nsubsteps 8\nwoven {\n warps 6\n wefts 6\n spacing 12 /cm\n stretch 0.5 N\n"
         " tear off\n drag 0 /s\n orientation horizontal\n}\npin row top\n",
         1e-4, 0.01);
  swings("membrane",
         "scene swing\nrate 1000 Hz\nmembrane {\n columns 3\n rows 6\n cell 1 cm\n material denim\n drag 0 /s\n"
         " orientation horizontal\n}\npin row top\n",
         1e-4, 0.002);
}

/* A hand draws a hanging cloth: its work by the views, impulse times velocity, is that of the ledger; and what
 * it supplied is stored or lost. */
static void a_hand_supplies_what_it_works(void) {
  fixture_scoped f = {0};
  fixture_file(&f, "tests/scenes/small.scene", NULL);
  (void)fixture_start_hands(&f, 300);
  fray_energy_watch(f.w);
  const double speed = fixture_speed(&f) * 0.01;
  const double mass = fixture_mass_g(&f) * 0.001;
  double work = 0;
  for (uint32_t tick = 0; tick < 200; ++tick) {
    const int32_t at[FRAY_HANDS][3] = {{0, 0, 0}, {(int32_t)tick * 10, -(int32_t)tick * 10, 0}};
    const fray_input input = fixture_poses(&f, at, tick);
    (void)fixture_tick(&f, &input);
    for (uint32_t b = 0; b < f.facts.bodies; ++b) {
      const fray_body v = fray_view_body(f.w, b);
      if (v.motion != FRAY_HAND) continue;
      for (uint32_t n = 0; n < 3; ++n) work += (double)v.impulse[n] * v.velocity[n] * speed * speed * mass;
    }
  }
  const fray_energy_account a = fray_energy(f.w);
  const double booked = (double)a.supplied[FRAY_SUPPLIED_HANDS] * unit_of(&f);
  printf("figure hand_work %.6g J by the views, %.6g J in the ledger\n", work, booked);
  CHECK(work > 0);
  CHECK(fabs(booked - work) <= 0.01 * work);
}

/* ---- workers ---- */

static void a_watched_tick_of_workers_is_the_same(void) {
  fixture_scoped watched = {0};
  fixture_scoped plain = {0};
  fixture_hanging(&watched, 60, 40, 8, "0 s", "0 %", "0.5 /s");
  fixture_hanging(&plain, 60, 40, 8, "0 s", "0 %", "0.5 /s");
  fray_energy_watch(watched.w);
  const size_t bytes = (fray_parallel_memory_size(watched.w, 2) + 63) / 64 * 64;
  void *memory = aligned_alloc(64, bytes);
  fray_parallel *parallel = fray_parallel_open(watched.w, 2, memory, bytes);
  CHECK(parallel != NULL);
  for (uint32_t tick = 0; tick < 20 && parallel != NULL; ++tick) {
    fray_output a;
    const uint32_t steps = fray_parallel_steps(parallel);
    for (uint32_t worker = 0; worker < 2; ++worker)
      for (uint32_t n = 0; n < steps; ++n) fray_parallel_step(parallel, worker, n, &fixture_idle, &a);
    const fray_output b = fixture_tick(&plain, &fixture_idle);
    CHECK(a.hash == b.hash);
    CHECK_EQ_INT(fray_energy(watched.w).ticks, tick + 1u);
  }
  free(memory);
}

static void an_unwatched_world_has_no_account(void) {
  fixture_scoped f = {0};
  fixture_text(&f, falling_woven);
  (void)fixture_tick(&f, &fixture_idle);
  static const fray_energy_account nothing;
  const fray_energy_account a = fray_energy(f.w);
  CHECK(memcmp(&a, &nothing, sizeof a) == 0);
}

int main(void) {
  TEST(wide_sums_and_products_are_exact);
  TEST(closes_in_every_kind_of_scene);
  TEST(free_fall_keeps_the_total);
  TEST(springs_keep_the_total);
  TEST(a_hand_supplies_what_it_works);
  TEST(a_watched_tick_of_workers_is_the_same);
  TEST(an_unwatched_world_has_no_account);
  return test_end();
}
