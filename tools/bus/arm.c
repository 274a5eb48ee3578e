/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bus/arm.h"

#include <string.h>

enum { FINE = 50 }; /* steps of a tick */

/* Its square root, by Newton's method: libm need not round it the same everywhere. */
static double root(double x) {
  double r = x > 1 ? x : 1;
  for (int n = 0; n < 60 && x > 0; n++) r = (r + x / r) / 2;
  return x > 0 ? r : 0;
}

arm arm_make(double mass, double stiffness, uint32_t delay) {
  arm a;
  memset(&a, 0, sizeof a);
  a.mass = mass;
  a.stiffness = stiffness;
  a.damping = 0.1 * root(stiffness * mass);
  a.delay = delay < 1 ? 1 : delay > ARM_DELAY_MAX ? ARM_DELAY_MAX : delay;
  return a;
}

/* A mind moves a hand smoothly: 20 rad/s, critically damped. */
static void move_aim(arm *a, int n, double goal, double h) {
  a->aim_speed[n] += ((goal - a->aim[n]) * 400 - a->aim_speed[n] * 40) * h;
  a->aim[n] += a->aim_speed[n] * h;
}

static int16_t pose_of(double metres) {
  const double steps = metres * 500000;
  if (steps >= 32767) return 32767;
  if (steps <= -32768) return -32768;
  return (int16_t)(steps < 0 ? steps - 0.5 : steps + 0.5);
}

void arm_tick(arm *a, const int16_t force[3], const double goal[3], double seconds,
              int16_t pose[3]) {
  const double h = seconds / FINE;
  memmove(a->force[1], a->force[0], sizeof a->force - sizeof a->force[0]);
  for (int n = 0; n < 3; n++) {
    a->force[0][n] = force[n] * 0.0005;
    const double held = a->force[a->delay - 1][n];
    for (int k = 0; k < FINE; k++) {
      move_aim(a, n, goal[n], h);
      const double own =
          a->stiffness * (a->aim[n] - a->at[n]) + a->damping * (a->aim_speed[n] - a->speed[n]);
      a->speed[n] += (held + own) / a->mass * h;
      a->at[n] += a->speed[n] * h;
      a->given -= held * a->speed[n] * h;
    }
    pose[n] = pose_of(a->at[n]);
  }
}
