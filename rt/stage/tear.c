/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the structural springs whose strain exceeds their own threshold (Metaaphanon 2009,
 * sections 3.2 and 4.1: those still over it after all projections and collisions).
 *
 * At most cuts_max are taken in a tick: those farthest over their threshold, ties by canonical
 * number. The others wait; they are tested again in the next tick, when the cuts around them may
 * have relieved them. */
#include "rt/model/couples.h"
#include "rt/stage/cuts.h"
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

/* n / limit - 1 in Q16, for n > limit; limits are below 2^47. */
static uint32_t excess_over(uint64_t n, uint64_t limit) {
  return fx_divide_wide(n - limit, (uint32_t)(limit >> 16) + 1u);
}

/* In worlds with yarns no spring is cut before its ends have split, where they can: held ones never
 * do, nor do others once the spare particles are used up. */
__attribute__((noinline)) static int ends_have_split(const fray_world *w, uint32_t row) {
  const uint32_t held = (uint32_t)w->params->held;
  const uint32_t i = w->row_i[row];
  const uint32_t j = w->row_j[row];
  return (i < held || couple_is_light(w, i)) && (j < held || couple_is_light(w, j));
}

/* What a class takes without a look at its draws, none of which is below tear_min. */
#if FX_NO_LONG_MULTIPLY
/* The square of a length in units of 2^LINK_SHIFT: with three components rounded down a way is less than
 * two of them too short, so it is that much below. One that is not within 2^22 may be any. */
typedef uint32_t tear_bound;
static inline tear_bound bound_of(int32_t rest, int32_t strain) {
  const uint32_t length = link_stretched(rest, strain) >> LINK_SHIFT;
  const uint32_t known = length < LINK_HI_MAX ? length : LINK_HI_MAX;
  return known < 2u ? 0 : (known - 2u) * (known - 2u);
}
static inline int is_within(vec3 d, tear_bound bound) {
  const int32_t wide = fx_wrap_add(d.x, 1 << 22) | fx_wrap_add(d.y, 1 << 22) | fx_wrap_add(d.z, 1 << 22);
  if ((uint32_t)wide >> 23 != 0) return 0;
  const int32_t x = fx_asr(d.x, LINK_SHIFT);
  const int32_t y = fx_asr(d.y, LINK_SHIFT);
  const int32_t z = fx_asr(d.z, LINK_SHIFT);
  return (uint32_t)(fx_mul(x, x) + fx_mul(y, y) + fx_mul(z, z)) <= bound;
}
#else
typedef uint64_t tear_bound;
static inline tear_bound bound_of(int32_t rest, int32_t strain) { return link_stretched_squared(rest, strain); }
static inline int is_within(vec3 d, tear_bound bound) { return vec_squared(d) <= bound; }
#endif

enum { KIND_NONE = 256 }; /* a row's is a byte */

/* Out of the way of rows of one kind, which follow one another. */
__attribute__((noinline)) static tear_bound bound_of_kind(const fray_world *w, int32_t rest) {
  return bound_of(rest, w->params->tear_min);
}

static inline void look_at(fray_world *w, uint32_t row, vec3 d, int32_t rest) {
  const uint64_t n = vec_squared(d);
  const uint64_t limit = link_stretched_squared(rest, world_threshold(w, row));
  if (n <= limit || (world_has_yarns(w) && !ends_have_split(w, row))) return;
  const cut found = {row, excess_over(n, limit)};
  cuts_enlist(w, found);
}

void tear_part(fray_world *w, uint32_t first, uint32_t end) {
  const params *p = w->params;
  if (p->tearing == 0) return;
  const link_view view = {w->x, w->y, w->z, w->row_i, w->row_j, w->row_class, w->links,
                          w->capacity[POOL_LINK_CLASSES]};
  uint32_t kind = KIND_NONE;
  int32_t rest = 0;
  tear_bound bound = 0;
  for (uint32_t row = first; row < end; ++row) {
    row = wide_over(w->kernel, view, p->tear_min, row, end);
    if (row == end) break;
    if (view.kind[row] != kind) {
      if (view.kind[row] == ROW_DEAD) continue;
      kind = view.kind[row];
      rest = view.classes[kind & ROW_CLASS].rest;
      bound = bound_of_kind(w, rest);
    }
    const vec3 d = vec_sub(world_position(w, view.j[row]), world_position(w, view.i[row]));
    if (!is_within(d, bound)) look_at(w, row, d, rest);
  }
  w->work.tear_tests += end - first;
  w->work.over += w->cut_count + w->cuts_waiting;
}

void tear_run(fray_world *w) { tear_part(w, 0, (uint32_t)w->params->links); }

uint32_t tear_worst(const fray_world *w) {
  uint32_t worst = 0;
  for (uint32_t n = 1; n < w->cut_count; ++n)
    if (cuts_worse(w, &w->cuts[n], &w->cuts[worst])) worst = n;
  return w->home[w->cuts[worst].row];
}
