/* SPDX-License-Identifier: Apache-2.0 */
/* The elastic steps of a membrane in a substep: forces, then constraints at the velocity, then
 * motion, of vertices and bodies alike. What acts within a step sees all that acts in it, and takes
 * energy. The guard behind the loop moves positions, and is rare. */
#include "rt/contact/constraints.h"
#include "rt/elastic/step_bodies.h"
#include "rt/elastic/step_handles.h"
#include "rt/elastic/step_passive.h"
#include "rt/membrane/membrane.h"
#include "rt/membrane/step_meter.h"
#include "rt/self_collision/impact_zone_steps.h"
#include "rt/self_collision/self_constraints.h"
#include "rt/tick/tick.h"

void elastic_steps_run(fray_world *w, uint32_t substep) {
  step_view view = membrane_step_begin(w);
  FRAY_ASSERT(world_has_membrane(w) && substep < (uint32_t)w->params->substeps);
  if (substep == 0) step_passive_begin(w);
  step_bodies_begin(w);
  edge_limits_find(w);
  impact_zone_steps_leave_edges(w);
  contact_constraints_find(w);
  world_edge_find(w);
  for (int32_t number = 0; number < w->membrane.constants->steps; ++number) {
    const elastic_step step = membrane_step_force(w, &view, substep, number);
    step_handles_mark(w);
    step_bodies_pull(w, &step);
    if (world_has_handles(w))
      step_handles_pull(w, &step, (int32_t)substep * w->membrane.constants->steps + number);
    step_passive_mark(w);
    step_meter_mark(w, 0);
    impact_zone_steps_hold(w, &step);
    step_meter_mark(w, 1);
    if (substep == 0 && number == 0) {
      step_meter_zones(w, &step);
      stretch_repay(w, &step);
      bend_repay(w, &step);
      impact_zone_steps_share(w, &step);
    }
    step_meter_mark(w, 2);
    edge_limits_solve(w, &step, EDGE_LENGTH);
    impact_zone_steps_share(w, &step);
    step_meter_mark(w, 3);
    contact_constraints_solve(w, &step);
    world_edge_solve(w, &step);
    impact_zone_steps_share(w, &step);
    step_meter_mark(w, 4);
    edge_limits_solve(w, &step, EDGE_RATE);
    impact_zone_steps_share(w, &step);
    step_meter_mark(w, 5);
    self_constraints_solve(w, &step);
    impact_zone_steps_share(w, &step);
    step_meter_mark(w, STEP_MARKS);
    step_handles_meter(w);
    membrane_step_move(w, &view);
    step_bodies_move(w, &step, number);
  }
  contact_guard_apply(w);
  membrane_step_end(w);
  step_bodies_end(w);
}
