/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles that are pressed together, or drawn thin.
 *
 *   fade     the least of 2 A / A_rest, 5/4 of its heights over those at rest, and 1. A fold's angle counts
 *            by the fade of both its triangles, so that forces stay bounded by those of half the area, and
 *            frequencies by 5/4 of those at rest: drawn sheets and strips that were pressed flat gained
 *            energy without end
 *   faded    1 - fade, the most that it was: in a bending step it only grows, which takes energy. Once a tick
 *            it goes back as slowly as the strain is smoothed, and what an angle that counts again makes is
 *            owed (bend_owed.c) */
#include "rt/membrane/membrane.h"

enum { FADED_LEAST_BITS = 12 };

int32_t bend_fade_of(const plate_view *view, uint32_t t, uint64_t squared, const uint32_t length[3]) {
  const uint32_t normal = fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
  const uint32_t area = view->area[t];
  const uint64_t twice = (uint64_t)normal << 2; /* the area, Q30 */
  int32_t fade = twice >= area ? BEND_ONE : (int32_t)fx_divide_wide(twice << 30, area);
  for (uint32_t k = 0; k < 3; ++k)
    fade = fx_min(fade, bend_fade_by_height(&view->shapes[t], k, normal, length[k]));
  return fade;
}

/* Returns whether one is left that is pressed. */
static int update_faded(fray_world *w) {
  const unsigned shift = (unsigned)w->membrane.constants->smoothing_shift;
  const int32_t *fade = bend_plate_column(w, PLATE_FADE);
  int32_t any = 0;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) {
    int32_t *const faded = &w->membrane.bend_states[t].faded;
    const int32_t slowly = *faded - (*faded >> shift);
    *faded = fx_max(BEND_ONE - fade[t], slowly >> FADED_LEAST_BITS == 0 ? 0 : slowly);
    any |= *faded;
  }
  return any != 0;
}

static int any_faded(const fray_world *w) {
  int32_t any = 0;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) any |= w->membrane.bend_states[t].faded;
  return any != 0;
}

void bend_folds_hold(fray_world *w) {
  const bend_state *states = w->membrane.bend_states;
  for (uint32_t n = 0; n < w->membrane.fold_count; ++n) {
    const uint32_t t = (uint32_t)bend_fold_column(w, FOLD_FIRST)[n] / 4u;
    const uint32_t o = (uint32_t)bend_fold_column(w, FOLD_SECOND)[n] / 4u;
    const int32_t by_first = fx_mul_round(bend_fold_column(w, FOLD_CAP)[n], BEND_ONE - states[t].faded, 30);
    bend_fold_column(w, FOLD_HOLD)[n] = fx_mul_round(by_first, BEND_ONE - states[o].faded, 30);
  }
}

void bend_fade_begin(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w));
  w->membrane.bend_faded = (uint8_t)any_faded(w);
  bend_folds_hold(w);
}

void bend_fade_follow(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w));
  w->membrane.bend_faded = (uint8_t)update_faded(w);
  bend_folds_hold(w);
}

void bend_press(fray_world *w, uint32_t t) {
  FRAY_ASSERT(t < triangles_in_use(w));
  const plate_view view = bend_plate_view(w);
  const index_t *v = w->trimesh.triangle[t].v;
  const vec3 e2 = bend_edge(w->membrane.positions, v[0], v[1]);
  const vec3 d2 = bend_edge(w->membrane.positions, v[0], v[2]);
  const uint64_t squared = vec_squared(vec_cross_q28(e2, d2));
  int32_t *const faded = &w->membrane.bend_states[t].faded;
  int32_t fade = 0;
  if (squared >= BEND_FLAT) {
    const uint32_t length[3] = {vec_length(vec_sub(d2, e2)), vec_length(d2), vec_length(e2)};
    fade = bend_fade_of(&view, t, squared, length);
  }
  *faded = fx_max(*faded, BEND_ONE - fade);
  if (*faded != 0) w->membrane.bend_faded = 1;
}
