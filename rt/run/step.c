/* SPDX-License-Identifier: Apache-2.0 */
/* The tick: the only file that knows the order of the stages. It is the loop of Metaaphanon 2009,
 * section 4 (its step numbers at the right), with the substeps around gravity, 4 to 6 and 8; bend,
 * shear and damping act once a tick, before them. */
#include "rt/run/step.h"

/* A seam for tools that time the stages; nothing on targets. */
#ifndef STEP_STAGE
#define STEP_STAGE(name, call) call
#endif

void fray_tick(fray_world *w, const fray_input *input, fray_output *output) {
  const uint32_t substeps = (uint32_t)w->params->substeps;
  step_begin(w, output);
  STEP_STAGE(DEVICES, devices_run(w, input));
  STEP_STAGE(DAMP, damp_run(w));       /* 3 */
  STEP_STAGE(SPRINGS, springs_run(w)); /* 1, 2: bend, shear; structural ones are projected */
  STEP_STAGE(STRESS, stress_run(w));
  STEP_STAGE(RIP, rip_run(w));
  STEP_STAGE(SLASH, slash_run(w));
  STEP_STAGE(WEIGH, weigh_run(w));
  STEP_STAGE(BLOW, blow_run(w));
  STEP_STAGE(GATHER, collide_gather(w));
  STEP_STAGE(SELVES, selves_begin(w));
  STEP_STAGE(LAYERS, layers_begin(w));
  for (uint32_t substep = 0; substep < substeps; ++substep) {
    STEP_STAGE(MESHES, meshes_begin(w));
    STEP_STAGE(PREDICT, predict_run(w, substep)); /* 1, 2, 4: gravity, positions */
    STEP_STAGE(STRAIN, strain_run(w));            /* 5 */
    STEP_STAGE(LIMIT, limit_run(w));
    STEP_STAGE(SLIP, slip_run(w, substep));       /* 5 */
    STEP_STAGE(COLLIDE, collide_run(w));          /* 6 */
    STEP_STAGE(MESHES, meshes_run(w));            /* 6 */
    if (substep + 1u == substeps) {
      STEP_STAGE(TRANSITION, transition_run(w)); /* 7 */
      STEP_STAGE(SPLIT, split_run(w));
      STEP_STAGE(TEAR, tear_run(w));
      STEP_STAGE(CUT, cut_run(w));
      STEP_STAGE(SELVES, selves_run(w));         /* 6 */
      STEP_STAGE(LAYERS, layers_run(w));         /* 6 */
    }
    STEP_STAGE(FINISH, finish_run(w)); /* 8 */
  }
  STEP_STAGE(FORCE, force_run(w, output->force));
  STEP_STAGE(REPORT, report_run(w, output));
}
