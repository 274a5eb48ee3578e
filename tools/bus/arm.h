/* SPDX-License-Identifier: Apache-2.0 */
/* A simulated arm that holds a device: a mass, a spring and a damper to where it wants to be. It
 * takes the forces of ticks and gives poses, so that the loop through a world closes. Sums and
 * products of doubles alone: the same bits on every machine that rounds each. */
#ifndef FRAY_TOOLS_BUS_ARM_H
#define FRAY_TOOLS_BUS_ARM_H

#include <stdint.h>

enum { ARM_DELAY_MAX = 4 };

typedef struct {
  double mass, stiffness, damping; /* kg, N/m, N s/m */
  uint32_t delay;              /* ticks from a force to the first pose that it has moved, 1 to 4 */
  double at[3], speed[3];      /* m, m/s */
  double aim[3], aim_speed[3]; /* where it wants to be */
  double force[ARM_DELAY_MAX][3]; /* N, newest first */
  double given;                   /* J, by the arm to the device */
} arm;

/* At rest at the device's origin. The damper is a tenth of the critical one. */
arm arm_make(double mass, double stiffness, uint32_t delay);
/* A tick of so many seconds: `force` of it, 0.5 mN a step, and where the aim goes, m. pose: at its
 * end, 2 um a step, held to the range of a pose. */
void arm_tick(arm *a, const int16_t force[3], const double goal[3], double seconds,
              int16_t pose[3]);

#endif
