/* SPDX-License-Identifier: Apache-2.0 */
/* The tick: poses in, one model's loop, forces out. */
#include "rt/tick/tick.h"

#include "rt/base/assert.h"
#include "rt/base/bytes.h"
#include "rt/energy/energy.h"
#include "rt/haptics/haptics.h"

void tick_start(fray_world *w, fray_output *output) {
  FRAY_ASSERT((uint32_t)w->params->bodies <= w->capacity[POOL_BODIES]);
  bytes_zero(output, sizeof *output);
  bytes_zero(w->rigid.motion, sizeof(body_motion) * w->capacity[POOL_BODIES]);
  bytes_zero(&w->work, sizeof w->work);
  w->woven.tear_count = 0;
  w->first_tear = 0;
  w->woven.tears_waiting = 0;
}

void fray_tick(fray_world *w, const fray_input *input, fray_output *output) {
  FRAY_ASSERT(w != NULL && input != NULL && output != NULL);
  tick_start(w, output);
  energy_begin(w);
  haptic_device_update(w, input);
  if (world_has_membrane(w))
    tick_membrane(w);
  else
    tick_woven(w);
  energy_end(w);
  haptic_force_update(w, output->force);
  tick_report(w, output);
}
