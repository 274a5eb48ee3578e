/* SPDX-License-Identifier: Apache-2.0 */
/* What a tick starts from, whoever runs it. */
#ifndef FRAY_RUN_STEP_H
#define FRAY_RUN_STEP_H

#include "rt/base/bytes.h"
#include "rt/stage/stage.h"

static inline void step_begin(fray_world *w, fray_output *output) {
  bytes_zero(output, sizeof *output);
  bytes_zero(w->motion, sizeof(body_motion) * w->capacity[POOL_BODIES]);
  bytes_zero(&w->work, sizeof w->work);
  w->cut_count = 0;
  w->cut_first = 0;
  w->cuts_waiting = 0;
}

#endif
