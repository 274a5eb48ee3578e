/* SPDX-License-Identifier: Apache-2.0 */
/* Cloth laid on bodies comes to rest: sheets of 6 x 6 cm that fall 3 mm on a plane, a box, a capsule, a
 * sphere and a mesh, free and pinned. A fall of 3 mm is 0.24 m/s; an end that hangs over falls by up to 5 cm, 1 m/s,
 * and then swings in air; some slide off the sphere. */
#include "tests/lib/test.h"

#include "tests/lib/world_fixture.h"

/* Their upper face is at y = 0; the sheet's underside 3 mm above it. */
static const struct {
  const char *name, *body;
  int swings; /* a part of the sheet hangs over it */
} supports[] = {
    {"plane", "plane s { at 0 0 0 cm }", 0},
    {"box", "box s { size 3 1 3 cm at 0 -0.5 0 cm }", 1},
    {"capsule", "capsule s { radius 0.5 cm length 8 cm at 0 -0.5 0 cm }", 1},
    {"sphere", "sphere s { radius 2 cm at 0 -2 0 cm }", 1},
    {"mesh", "mesh s { obj \"meshes/box.obj\" unit 1.5 cm at 0 -0.75 0 cm }", 1},
};
static const char *const fabrics[] = {"paper", "denim", "t-shirt"};

static double speed_of(const fixture *f, uint32_t p) {
  const fray_particles v = fray_view_particles(f->w);
  const double lu = f->facts.lu_um * 1e-6 * 0x1p-28 * f->facts.rate_hz * f->facts.substeps;
  return lu * sqrt((double)v.vx[p] * v.vx[p] + (double)v.vy[p] * v.vy[p] + (double)v.vz[p] * v.vz[p]);
}

static double fastest_of(const fixture *f) {
  double most = 0;
  for (uint32_t p = particles_attached(f->w); p < f->w->p.count; ++p) most = fmax(most, speed_of(f, p));
  return most;
}
static double rms_of(const fixture *f) {
  double sum = 0;
  for (uint32_t p = particles_attached(f->w); p < f->w->p.count; ++p) sum += speed_of(f, p) * speed_of(f, p);
  return sqrt(sum / (f->w->p.count - particles_attached(f->w)));
}

/* Paper and its like hold more than 100 elastic steps a tick at 240 Hz. */
#define SHEET(more) \
  "membrane { columns 6 rows 6 cell 1 cm material %s at 0 %g 0 cm orientation horizontal strain_limit 20 %% " more \
  "}\n"

static void lies(uint32_t fabric, uint32_t support, int pinned, int rate) {
  fixture_scoped f = {0};
  char text[1024];
  snprintf(text, sizeof text, "scene calm\nrate %d Hz\n" SHEET("") "%s\n%s", rate, fabrics[fabric], 0.31,
           supports[support].body, pinned ? "pin column left\n" : "");
  fixture_text_of(&f, "tests/scenes/calm.scene", text);
  double fastest = 0;
  for (int tick = 0; tick < 2 * rate; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    if (tick < rate) fastest = fmax(fastest, fastest_of(&f));
  }
  const double rms = rms_of(&f);
  printf("figure calm_%s_%s_%s_%d %.3f m/s at most, %.4f mm/s rms at 2 s, faults 0x%02X\n", fabrics[fabric],
         supports[support].name, pinned ? "pinned" : "free", rate, fastest, rms * 1e3,
         (unsigned)f.w->state->faults);
  const int rests = !supports[support].swings && !pinned;
  const int slides_off = !pinned && strcmp(supports[support].name, "sphere") == 0;
  CHECK(fastest < (rests ? 0.3 : 1.25));
  CHECK(rms < (rests ? 0.3e-3 : 0.15) || slides_off);
}

static int every_rate;

static void everything_comes_to_rest(void) {
  static const int rates[] = {240, 500, 1000, 2000};
  for (uint32_t rate = 0; rate < sizeof rates / sizeof rates[0]; rate += every_rate ? 1 : 2 + TEST_FEWER)
    for (uint32_t fabric = 0; fabric < sizeof fabrics / sizeof fabrics[0]; ++fabric)
      for (uint32_t support = 0; support < sizeof supports / sizeof supports[0]; ++support)
        for (int pinned = 0; pinned < 2; ++pinned) lies(fabric, support, pinned, rates[rate]);
}

/* A sphere goes 6 mm into a sheet that is held on two sides, and stays. */
static void a_pressed_sphere_feels_a_steady_force(void) {
  for (uint32_t n = 0; n < 3; ++n) {
    fixture_scoped f = {0};
    fixture_print(&f, "scene pressed\nrate 1000 Hz\n" SHEET("") "pin column left\npin column right\n"
                  "sphere s { radius 1 cm move path { 0 s 0 1.02 0 cm 0.2 s 0 0.40 0 cm } at 0 1.02 0 cm }\n",
                  fabrics[n], 0.0);
    const double newton = 0x1p-28 * f.facts.particle_mass_ng * 1e-12 * f.facts.lu_um * 1e-6 * f.facts.substeps *
                          f.facts.rate_hz * f.facts.rate_hz;
    double sum = 0, squares = 0;
    for (int tick = 0; tick < 2000; ++tick) {
      (void)fixture_tick(&f, &fixture_idle);
      const double force = -(double)f.w->rigid.motion[0].impulse[1] * newton;
      if (tick < 1000) continue;
      sum += force / 1000;
      squares += force * force / 1000;
    }
    const double noise = sqrt(fmax(0, squares - sum * sum));
    printf("figure pressed_%s force %.4f N, noise %.2f mN rms (asked: 10), fastest %.3f m/s\n", fabrics[n], sum,
           noise * 1e3, fastest_of(&f));
    CHECK(sum > 0 && noise < 10e-3);
  }
}

/* A sphere of 1 to 100 times the sheet's mass falls 2 cm on it: the sheet moves with no more than the energy of that
 * fall and of what it and the sphere fall further. */
static void a_heavy_sphere_gives_no_more_than_it_has(void) {
  static const double times[] = {1, 3, 10, 30, 100};
  for (uint32_t n = 0; n < 15; n += (TEST_FEWER + 3) / 4) {
    fixture_scoped f = {0};
    double mass = 0;
    for (int known = 0; known < 2; ++known) {
      fixture_close(&f);
      fixture_print(&f, "scene dropped\nrate 1000 Hz\n" SHEET("") "pin column left\npin column right\n"
                    "sphere s { radius 1 cm move free mass %g g at 0 3 0 cm }\n", fabrics[n / 5], 0.0,
                    known ? mass * 1e3 * times[n % 5] : 10.0);
      for (uint32_t p = 0; p < f.w->p.count && !known; ++p)
        mass += (double)f.w->trimesh.mass[p] / f.w->membrane.constants->mass_unit * f.facts.particle_mass_ng * 1e-12;
    }
    fray_energy_watch(f.w);
    double fastest = 0, most = 0, fallen = 0;
    for (int tick = 0; tick < 500; ++tick) {
      (void)fixture_tick(&f, &fixture_idle);
      const fray_energy_account k = fray_energy(f.w);
      const double kinetic = (double)k.stored[FRAY_STORED_KINETIC] + (double)k.stored[FRAY_STORED_BODIES];
      fallen = fmax(fallen, (double)k.gravity);
      if (tick > 0) most = fmax(most, kinetic / fallen);
      fastest = fmax(fastest, fastest_of(&f));
    }
    printf("figure dropped_%s_%.0f sphere at %.1f cm, fastest vertex %.2f m/s, kinetic at most %.3f of gravity's work "
           "(asked: 1), faults 0x%02X\n", fabrics[n / 5], times[n % 5],
           f.w->rigid.states[0].position[1] * 0x1p-24 * f.facts.lu_um * 1e-4, fastest, most,
           (unsigned)f.w->state->faults);
    CHECK(most <= 1.01);
  }
}

/* `all` lays them at every rate, by default at the slowest and the fastest. */
int main(int count, char **words) {
  every_rate = count > 1 && strcmp(words[1], "all") == 0;
  TEST(everything_comes_to_rest);
  TEST(a_pressed_sphere_feels_a_steady_force);
  TEST(a_heavy_sphere_gives_no_more_than_it_has);
  return test_end();
}
