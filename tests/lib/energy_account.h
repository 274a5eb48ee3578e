/* SPDX-License-Identifier: Apache-2.0 */
/* Sums of the energy ledger, in its units, and a sheet that is torn under its watch. Nothing where FRAY_ENERGY is 0. */
#ifndef FRAY_TESTS_LIB_ENERGY_ACCOUNT_H
#define FRAY_TESTS_LIB_ENERGY_ACCOUNT_H

#include "tests/lib/test.h"

#include "tests/lib/world_fixture.h"

#if FRAY_ENERGY

static inline double account_stored(const fray_energy_account *a) {
  double sum = 0;
  for (uint32_t n = 0; n < FRAY_ENERGY_STORES; ++n) sum += (double)a->stored[n];
  return sum;
}

/* Magnitudes of all that was supplied, and of gravity's work. */
static inline double account_supplied(const fray_energy_account *a) {
  double sum = fabs((double)a->gravity);
  for (uint32_t n = 0; n < FRAY_ENERGY_SUPPLIES; ++n) sum += fabs((double)a->supplied[n]);
  return sum;
}

/* What a stage made less what it lost. */
static inline double account_net(const fray_energy_account *a, uint32_t stage) {
  return (double)a->made[stage] - (double)a->lost[stage];
}

/* Held at two rows, one of them dragged away in 0.1 s, a sheet of `material` tears, and splinters stay between: the
 * most that is stored, of what the moved row has supplied. */
static inline double energy_of_dragged_sheet(const char *material) {
  enum { TICKS = 400 };
  fixture_scoped f = {0};
  double most = 0;
  uint32_t tears = 0;
  fixture_print(&f, "scene drag\nrate 1000 Hz\ngravity 0 0 0 cm/s2\nmembrane {\n columns 8\n rows 8\n cell 1 cm\n"
                    " pattern irregular 3\n material rag\n drag 0 /s\n}\nmaterial rag {\n%s tear_interval 1 ms\n}\n"
                    "pin row top\npin row bottom by b\nsphere b {\n radius 1 cm\n at 0 -100 0 cm\n"
                    " move path { 0 s 0 -100 0 cm  0.05 s 0 -100 12 cm  0.1 s 0 -110 0 cm }\n}\n", material);
  fray_energy_watch(f.w);
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    tears = fixture_tick(&f, &fixture_idle).tears_total;
    const fray_energy_account a = fray_energy(f.w);
    most = fmax(most, account_stored(&a) / (double)a.supplied[FRAY_SUPPLIED_BODIES]);
  }
  CHECK(tears > 30);
  return most;
}

#endif
#endif
