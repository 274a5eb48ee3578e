/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wire/sequence.h"

#include <stddef.h>

#include "rt/base/assert.h"

void sequence_begin(sequence *s, uint8_t last) {
  FRAY_ASSERT(s != NULL);
  s->last = last & 15u;
  s->old_next = 0;
  s->old_run = 0;
}

uint32_t sequence_ahead(const sequence *s, uint8_t counter) {
  FRAY_ASSERT(s != NULL && s->last <= 15);
  FRAY_ASSERT(counter <= 15);
  return ((uint32_t)counter + 16u - s->last) & 15u;
}

sequence_result sequence_take(sequence *s, uint8_t counter) {
  FRAY_ASSERT(s->old_next <= 15 && s->old_run < SEQUENCE_RESTART);
  const uint32_t ahead = sequence_ahead(s, counter);
  if (ahead == 0) return SEQUENCE_REPEATED;
  if (ahead > SEQUENCE_AHEAD) {
    s->old_run = s->old_run > 0 && counter == s->old_next ? (uint8_t)(s->old_run + 1u) : 1u;
    s->old_next = (uint8_t)((counter + 1u) & 15u);
    if (s->old_run < SEQUENCE_RESTART) return SEQUENCE_OLD;
  }
  s->last = counter;
  s->old_run = 0;
  return SEQUENCE_NEW;
}
