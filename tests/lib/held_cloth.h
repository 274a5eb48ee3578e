/* SPDX-License-Identifier: Apache-2.0 */
/* A cloth of 6 x 4 cm between two handles, in the hands of simulated arms. */
#ifndef FRAY_TESTS_LIB_HELD_CLOTH_H
#define FRAY_TESTS_LIB_HELD_CLOTH_H

#include "tests/lib/world_fixture.h"
#include "tools/bus/arm.h"

/* rate: Hz. coupling: N/m. cloth, hands, handle: more keys of these blocks, a line each. */
FIXTURE void held_cloth_open_at(fixture *f, uint32_t rate, uint32_t coupling, const char *cloth,
                                const char *hands, const char *handle) {
  fixture_print(
      f,
      "scene held\nrate %u Hz\ngravity 0 0 0 cm/s2\nmembrane {\n columns 6\n rows 4\n cell 1 cm\n"
      " material cloth\n drag 0 /s\n}\n"
      "material cloth {\n density 200 g/m2\n isotropic 1000 N/m 0.3\n%s}\nhands {\n%s}\n"
      "box left {\n size 0.2 4.2 0.2 cm\n at -3 0 0 cm\n move hand left\n mass 5 g\n coupling %u "
      "N/m\n"
      " attach_within 0 cm\n%s}\n"
      "box right {\n size 0.2 4.2 0.2 cm\n at 3 0 0 cm\n move hand right\n mass 5 g\n coupling %u "
      "N/m\n"
      " attach_within 0 cm\n%s}\n",
      rate, cloth, hands, coupling, handle, coupling, handle);
}

FIXTURE void held_cloth_open(fixture *f, uint32_t coupling, const char *cloth, const char *hands,
                             const char *handle) {
  held_cloth_open_at(f, 1000, coupling, cloth, hands, handle);
}

/* Both hands for a tick: poses from the arms' last tick, forces to them. goals: m. */
FIXTURE fray_output held_cloth_tick(fixture *f, arm arms[FRAY_HANDS], int16_t poses[FRAY_HANDS][3],
                                    const double goals[FRAY_HANDS][3], uint32_t tick) {
  int32_t at[FRAY_HANDS][3];
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    for (uint32_t n = 0; n < 3; ++n) at[h][n] = poses[h][n];
  const fray_input input = fixture_poses(f, (const int32_t(*)[3])at, tick);
  const fray_output out = fixture_tick(f, &input);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    arm_tick(&arms[h], out.force[h], goals[h], 1.0 / f->facts.rate_hz, poses[h]);
  return out;
}

#endif
