/* SPDX-License-Identifier: Apache-2.0 */
/* What rt/fray.h says of states and hands, in its own terms. */
#ifndef FRAY_TESTS_LIB_STATE_MODEL_H
#define FRAY_TESTS_LIB_STATE_MODEL_H

#include <math.h>

#include "rt/fray.h"

enum { MODEL_ARM = 16, MODEL_RAMP = 100, MODEL_FADE = 10, MODEL_STALE = 3, MODEL_UNKNOWN_VERB = 77 };

typedef struct {
  int state, starting, muted;
  uint32_t good[2], missing[2]; /* ticks in a row with a pose of each hand, and without */
  uint32_t since_up;            /* ticks in a row without a right to force; large: never had one */
  double ramp;                  /* share of the force that may be let out */
  int faults;
} state_model;

static inline fray_result state_model_verb(state_model *m, uint32_t verb) {
  switch (verb) {
    case FRAY_COMMAND_NONE:
      return FRAY_RESULT_OK;
    case FRAY_COMMAND_START:
      if (m->state == FRAY_SAFE) return FRAY_RESULT_REFUSED;
      m->starting = m->state == FRAY_READY;
      m->muted = 0;
      return FRAY_RESULT_OK;
    case FRAY_COMMAND_STOP:
      if (m->state == FRAY_SAFE) return FRAY_RESULT_REFUSED;
      m->starting = 0;
      m->state = FRAY_READY;
      return FRAY_RESULT_OK;
    case FRAY_COMMAND_RESET:
      if (m->state != FRAY_SAFE) return FRAY_RESULT_REFUSED;
      m->state = FRAY_READY;
      m->faults = 0;
      return FRAY_RESULT_OK;
    case FRAY_COMMAND_ZERO:
      if (m->state != FRAY_OPERATIONAL) return FRAY_RESULT_REFUSED;
      m->muted = 1;
      return FRAY_RESULT_OK;
    case FRAY_COMMAND_HALT:
      m->starting = 0;
      m->state = FRAY_SAFE;
      m->faults |= FRAY_FAULT_HALTED;
      return FRAY_RESULT_OK;
    default:
      return FRAY_RESULT_UNKNOWN;
  }
}

static inline fray_result state_model_tick(state_model *m, uint8_t has_pose, uint32_t verb) {
  for (uint32_t h = 0; h < 2; ++h) {
    const int has = has_pose >> h & 1;
    m->good[h] = has ? m->good[h] + 1 : 0;
    m->missing[h] = has ? 0 : m->missing[h] + 1;
  }
  const fray_result result = state_model_verb(m, verb);
  if (m->state == FRAY_READY && m->starting && m->good[0] >= MODEL_ARM && m->good[1] >= MODEL_ARM) {
    m->state = FRAY_OPERATIONAL;
    m->starting = 0;
  }
  if (m->state == FRAY_OPERATIONAL && (m->missing[0] >= MODEL_STALE || m->missing[1] >= MODEL_STALE)) {
    m->state = FRAY_SAFE;
    if (m->missing[0] >= MODEL_STALE) m->faults |= FRAY_FAULT_STALE_LEFT;
    if (m->missing[1] >= MODEL_STALE) m->faults |= FRAY_FAULT_STALE_RIGHT;
  }
  const int up = m->state == FRAY_OPERATIONAL && !m->muted;
  m->since_up = up ? 0 : m->since_up + 1;
  m->ramp = up ? fmin(1, m->ramp + 1.0 / MODEL_RAMP) : fmax(0, m->ramp - 1.0 / MODEL_FADE);
  return result;
}

#endif
