/* SPDX-License-Identifier: Apache-2.0 */
/* Wind on light cloth. Air acts once a tick: on a few g/m2 it would turn the velocity of a triangle round, tick by
 * tick faster. Moving air gives at most its velocity times the momentum that it gives, and air at rest takes. */
#include "rt/membrane/membrane.h"
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

enum { MILLISECONDS = 200 / TEST_FEWER, CASES = 4 * 2 * 2 * 3, PARTICLES = 64 };

/* A free sheet without gravity and drag, which trembles and flies upwards. */
static void open_sheet(fixture *f, double density, double stiffness, uint32_t rate, const char *wind, double up) {
  uint64_t seed = 7;
  fixture_print(f,
                "scene sheet\nrate %u Hz\nsubsteps 1\ngravity 0 0 0 cm/s2\nwind %s m/s\nmembrane {\n columns 6\n rows 5\n"
                " cell 5 cm\n pattern irregular 3\n material film\n drag 0 /s\n wind_drag 0.3\n}\n"
                "material film {\n density %g g/m2\n isotropic %g N/m 0.3\n}\n",
                rate, wind, density, stiffness);
  fray_world *w = f->w;
  const double unit = 0x1p28 / (f->facts.lu_um * 1e-6 * rate);
  int32_t *const v[3] = {w->p.vx, w->p.vy, w->p.vz};
  for (uint32_t n = 0; n < 3; ++n)
    for (uint32_t p = 0; p < w->p.count; ++p)
      v[n][p] = (int32_t)(unit * ((n == 1 ? up : 0) + (double)splitmix64(&seed) * 0x1p-63 - 1));
  fray_energy_watch(w);
}

/* Energy of cloth that moves with the air, in units of the ledger. */
static double moving_with_air(const fray_world *w) {
  const int32_t *wind = w->membrane.constants->wind;
  double sum = 0;
  for (uint32_t p = 0; p < w->p.count; ++p)
    for (uint32_t n = 0; n < 3; ++n)
      sum += (double)w->trimesh.mass[p] / w->membrane.constants->mass_unit * wind[n] * wind[n] * 0x1p-17;
  return sum;
}

/* What the wind would give now beyond its velocity times momentum: m d.(v + d / 2 - wind), summed. */
static double given_beyond(fray_world *w) {
  int32_t *const v[3] = {w->p.vx, w->p.vy, w->p.vz};
  const int32_t *wind = w->membrane.constants->wind;
  int32_t before[3][PARTICLES];
  double sum = 0;
  for (uint32_t n = 0; n < 3; ++n) memcpy(before[n], v[n], w->p.count * sizeof *v[n]);
  wind_apply(w);
  for (uint32_t p = 0; p < w->p.count; ++p)
    for (uint32_t n = 0; n < 3; ++n) {
      const double by = (double)v[n][p] - before[n][p];
      sum += (double)w->trimesh.mass[p] / w->membrane.constants->mass_unit * by * (before[n][p] + by / 2 - wind[n]) * 0x1p-16;
    }
  for (uint32_t n = 0; n < 3; ++n) memcpy(v[n], before[n], w->p.count * sizeof *v[n]);
  return sum;
}

typedef struct {
  double most, start, air; /* energies */
  double given;            /* by wind beyond its velocity times momentum: the most in a tick */
} account;

static account blow(fixture *f) {
  account a = {0, 0, moving_with_air(f->w), 0};
  for (uint32_t tick = 0; tick < MILLISECONDS * f->facts.rate_hz / 1000; ++tick) {
    if (tick != 0) a.given = fmax(a.given, given_beyond(f->w));
    (void)fixture_tick(f, &fixture_idle);
    const fray_energy_account k = fray_energy(f->w);
    double total = 0;
    for (uint32_t n = 0; n < FRAY_ENERGY_STORES; ++n) total += (double)k.stored[n];
    a.start = (double)k.begun;
    a.most = fmax(a.most, total);
  }
  return a;
}

static void air_is_passive(void) {
  static const double densities[] = {2, 5, 20, 200};
  static const double stiffness[] = {5, 200};
  static const uint32_t rates[] = {240, 1000};
  static const char *const winds[] = {"0 0 0", "0 15 0", "6 9 -3"};
  double worst = 0;
  double most = 0;
  for (uint32_t n = 0; n < CASES; ++n) {
    fixture_scoped f = {0};
    open_sheet(&f, densities[n % 4], stiffness[n / 4 % 2], rates[n / 8 % 2], winds[n / 16], n / 16 == 0 ? 15 : 0);
    const account a = blow(&f);
    worst = fmax(worst, a.given / a.start);
    most = fmax(most, a.most / (a.start + a.air));
    CHECK(a.given <= 1e-6 * a.start);
    CHECK(a.most <= a.start + a.air);
  }
  figure("wind_beyond_its_work", worst, "of the energy at the start", "at most 1e-6: rounding");
  figure("wind_energy_most", most, "of the start's and of cloth that moves with the air", "at most 1");
}

int main(void) {
  TEST(air_is_passive);
  return test_end();
}
