/* SPDX-License-Identifier: Apache-2.0 */
/* A cloth that two hands tear, with springs that wait and contacts that do not fit: for tests of ticks that are
 * shared. A rail (fixed, or on a path), a ground where `more` says so. */
#ifndef FRAY_TESTS_LIB_TORN_BY_HANDS_H
#define FRAY_TESTS_LIB_TORN_BY_HANDS_H

#include "tests/lib/world_fixture.h"

FIXTURE void torn_open(fixture *f, const char *substeps, const char *damping, const char *more) {
  fixture_print(f,
                "scene torn\nrate 1000 Hz\n%s\ngravity 0 -981 3 cm/s2\nseed 5\n"
                "woven {\n warps 26\n wefts 22\n spacing 12 /cm\n density 0.25 g/cm2\n"
                " thickness 0.01 cm\n structural 6000 g/s2\n bend 5 g/s2\n shear 2 g/s2\n"
                " tear 3 5 %%\n drag 2 /s\n %s\n}\n"
                "sphere left {\n radius 0.2 cm\n at -1 0.87 0 cm\n move hand left\n attach_within 0.1 cm\n}\n"
                "sphere right {\n radius 0.2 cm\n at 1 0.87 0 cm\n move hand right\n attach_within 0.1 cm\n}\n"
                "capsule rail {\n length 2 cm\n radius 0.1 cm\n %s\n}\n"
                "limits {\n contacts 120\n tears_per_tick 2\n}\n",
                substeps, damping, more);
}

/* Hands stand for 30 ticks, then go apart. */
FIXTURE fray_input torn_input(const fixture *f, uint32_t tick) {
  const int32_t displacement = tick < 30 ? 0 : fx_min(((int32_t)tick - 30) * 90, 30000);
  const int32_t at[FRAY_HANDS][3] = {{-displacement, 0, displacement / 4}, {displacement, displacement / 3, 0}};
  fray_input input = fixture_poses(f, at, tick);
  if (tick == 0) input.command = FRAY_COMMAND_START;
  return input;
}

#endif
