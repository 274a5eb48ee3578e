/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L

#include "tools/bench/timed_tick.h"

#include <time.h>

#include "rt/contact/contact.h"
#include "rt/haptics/haptics.h"
#include "rt/integrate/integrate.h"
#include "rt/membrane/membrane.h"
#include "rt/self_collision/self_collision.h"
#include "rt/self_collision/self_constraints.h"
#include "rt/tick/rollback.h"
#include "rt/tick/tick.h"
#include "rt/woven/woven.h"

double timed_ns[TIMED_COUNT];
const char *const timed_labels[TIMED_COUNT] = {
#define X(name, label) label,
    TIMED_STAGES(X)
#undef X
};

static double clock_ns(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec * 1e9 + (double)now.tv_nsec;
}

double timed_now_ns(void) { return clock_ns(CLOCK_MONOTONIC); }

double timed_cpu_ns(void) { return clock_ns(CLOCK_THREAD_CPUTIME_ID); }

/* One look at the clock a stage: a stage lasts from the end of the one before. */
static double stage_began_ns;
int timed_by_cpu;

static double stage_clock_ns(void) { return timed_by_cpu ? timed_cpu_ns() : timed_now_ns(); }

static void end_stage(timed_stage stage) {
  const double now = stage_clock_ns();
  timed_ns[stage] += now - stage_began_ns;
  stage_began_ns = now;
}

/* Each call of a stage in the files of the tick, with a look at the clock behind it. */
#define TIMED(stage, call) \
  do { \
    call; \
    end_stage(TIMED_##stage); \
  } while (0)
#define haptic_device_update(w, input) TIMED(DEVICES, haptic_device_update(w, input))
#define damp_apply(w) TIMED(DAMP, damp_apply(w))
#define bend_shear_apply(w) TIMED(BEND_SHEAR, bend_shear_apply(w))
#define membrane_stress_update(w) TIMED(STRESS, membrane_stress_update(w))
#define membrane_tear_apply(w) TIMED(MEMBRANE_TEAR, membrane_tear_apply(w))
#define crack_advance(w) TIMED(CRACK, crack_advance(w))
#define blade_cut_apply(w) TIMED(BLADE_CUT, blade_cut_apply(w))
#define membrane_gains_update(w) TIMED(GAINS, membrane_gains_update(w))
#define wind_apply(w) TIMED(WIND, wind_apply(w))
#define contact_gather(w) TIMED(GATHER, contact_gather(w))
#define yarn_collision_begin(w) TIMED(YARN_COLLISION, yarn_collision_begin(w))
#define yarn_collision_solve(w) TIMED(YARN_COLLISION, yarn_collision_solve(w))
#define triangle_collision_begin(w) TIMED(TRIANGLE_COLLISION, triangle_collision_begin(w))
#define triangle_collision_solve(w) TIMED(TRIANGLE_COLLISION, triangle_collision_solve(w))
#define rollback_save(w) TIMED(TRIANGLE_COLLISION, rollback_save(w))
#define rollback_restore(w) TIMED(TRIANGLE_COLLISION, rollback_restore(w))
#define self_constraints_find(w) TIMED(TRIANGLE_COLLISION, self_constraints_find(w))
#define self_constraints_begin(w) TIMED(TRIANGLE_COLLISION, self_constraints_begin(w))
#define contact_vertices_begin(w) TIMED(CONTACT_VERTICES, contact_vertices_begin(w))
#define contact_vertices_solve(w) TIMED(CONTACT_VERTICES, contact_vertices_solve(w))
#define bodies_advance(w, substep) TIMED(ADVANCE, bodies_advance(w, substep))
#define particles_advance(w) TIMED(ADVANCE, particles_advance(w))
#define particles_carry(w) TIMED(ADVANCE, particles_carry(w))
#define yarn_stretch_run(w) TIMED(ELASTIC, yarn_stretch_run(w))
#define elastic_steps_run(w, substep) TIMED(ELASTIC, elastic_steps_run(w, substep))
#define strain_limit_apply(w) TIMED(STRAIN, strain_limit_apply(w))
#define yarn_grip_update(w) TIMED(YARN_SLIP, yarn_grip_update(w))
#define yarn_slip_before_breaks(w) TIMED(YARN_SLIP, yarn_slip_before_breaks(w))
#define yarn_slip_after_breaks(w) TIMED(YARN_SLIP, yarn_slip_after_breaks(w))
#define yarn_slip_apply(w) TIMED(YARN_SLIP, yarn_slip_apply(w))
#define contact_primitives_solve(w) TIMED(CONTACT_PRIMITIVES, contact_primitives_solve(w))
#define crossing_transition_find(w) TIMED(TRANSITION, crossing_transition_find(w))
#define crossing_split_apply(w) TIMED(SPLIT, crossing_split_apply(w))
#define spring_tear_find(w) TIMED(TEAR, spring_tear_find(w))
#define spring_break_apply(w) TIMED(BREAK, spring_break_apply(w))
#define particles_hold(w) TIMED(VELOCITY, particles_hold(w))
#define particles_update_velocity(w) TIMED(VELOCITY, particles_update_velocity(w))
#define contact_update_velocity(w) TIMED(VELOCITY, contact_update_velocity(w))
#define bodies_update_velocity(w) TIMED(VELOCITY, bodies_update_velocity(w))
#define haptic_force_update(w, force) TIMED(FORCE, haptic_force_update(w, force))
#define tick_report(w, output) TIMED(REPORT, tick_report(w, output))
#define fray_tick timed_step
#define tick_start timed_begin
#define tick_woven timed_woven
#define tick_membrane timed_membrane
void tick_start(fray_world *w, fray_output *output);
void tick_woven(fray_world *w);
void tick_membrane(fray_world *w);
void fray_tick(fray_world *w, const fray_input *input, fray_output *output);
#include "rt/tick/tick.c"
#include "rt/tick/tick_membrane.c"
#include "rt/tick/tick_woven.c"

void timed_tick(fray_world *world, const fray_input *input, fray_output *output) {
  stage_began_ns = stage_clock_ns();
  timed_step(world, input, output);
}
