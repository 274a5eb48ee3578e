/* SPDX-License-Identifier: Apache-2.0 */
/* Handles of a loaded image. */
#include "rt/image/image.h"

#if FRAY_HANDLES

#define X(name, min, max) {min, max},
static const word_range handle_params_ranges[HANDLE_PARAM_WORDS] = {HANDLE_PARAMS(X)};
static const word_range handle_state_ranges[HANDLE_STATE_WORDS] = {HANDLE_STATE(X)};
#undef X

/* k h^2 / M of an elastic step is at most 1/4, far from 4 with the cloth beside it; and the damper stops the
 * body beside its proxy at most, so that its impulse takes energy. */
static int handle_bears(const fray_world *w, const handle_params *k) {
  const uint64_t ratio = (uint32_t)w->rigid.bodies[k->body].mass_ratio;
  const uint64_t steps = (uint32_t)w->membrane.constants->steps;
  return (uint32_t)k->spring * ratio <= steps << 44 && (uint32_t)k->damping * ratio <= (uint64_t)1
                                                                                           << 46;
}

int handles_validate(const fray_world *w, int32_t *hands, fray_error *error) {
  *hands = 0;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    const handle_params *k = &w->handles.constants[h];
    if (!image_words_in_range(k, handle_params_ranges, HANDLE_PARAM_WORDS, IMAGE_HANDLE_PARAMS,
                              error) ||
        !image_words_in_range(&w->handles.states[h], handle_state_ranges, HANDLE_STATE_WORDS,
                              IMAGE_HANDLE_STATES, error))
      return 0;
    if (k->body == HANDLE_NONE) continue;
    if (!world_has_membrane(w) || (uint32_t)k->body >= w->capacity[POOL_BODIES] ||
        w->rigid.bodies[k->body].motion != FRAY_FREE ||
        (uint32_t)w->rigid.bodies[k->body].hand != h)
      return image_bad(error, IMAGE_HANDLE_PARAMS, h,
                       "a free body of that hand, beside a membrane");
    if (w->rigid.bodies[k->body].mass_ratio < 1 || w->rigid.bodies[k->body].mass_ratio > 1 << 30 ||
        !handle_bears(w, k))
      return image_bad(error, IMAGE_HANDLE_PARAMS, h, "a coupling that the elastic steps bear");
    *hands |= 1 << h;
  }
  return 1;
}

#endif
