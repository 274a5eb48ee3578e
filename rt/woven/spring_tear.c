/* SPDX-License-Identifier: Apache-2.0 */
/* SIMD twin of the scan: rt/simd/tear_scan_lanes.inl.h, which skips springs below tear_min.
 *
 * Finds the structural springs with a strain over their own threshold (Metaaphanon 2009, sections 3.2 and
 * 4.1: those still over it after all projections and collisions).
 *
 * At most tears_max break in a tick: those farthest over their threshold, ties by canonical id. The others
 * are tested again in the next tick, when the breaks around them may have relieved them. */
#include "rt/simd/simd.h"
#include "rt/state/crossing.h"
#include "rt/woven/tear_queue.h"
#include "rt/woven/woven.h"
#include "rt/woven/woven_links.h"

/* n / limit - 1 in Q16, for n > limit; limits are below 2^47. */
static uint32_t excess_over(uint64_t n, uint64_t limit) {
  FRAY_ASSERT(n > limit && limit < (uint64_t)1 << 47);
  return fx_divide_wide(n - limit, (uint32_t)(limit >> 16) + 1u);
}

/* In worlds with yarns no spring breaks before its ends have split, where they can: attached ends never
 * split, nor does any once the spare particles are used up. */
__attribute__((noinline)) static int ends_have_split(const fray_world *w, uint32_t spring) {
  const uint32_t attached = particles_attached(w);
  const uint32_t i = w->woven.spring_i[spring];
  const uint32_t j = w->woven.spring_j[spring];
  return (i < attached || particle_is_half(w, i)) && (j < attached || particle_is_half(w, j));
}

/* A squared length that no spring of a class breaks below, whatever its own threshold: that at tear_min. */
#if FX_NO_LONG_MULTIPLY
/* In units of 2^LINK_SHIFT: with three components rounded down a distance comes out less than two units too
 * short, so the bound is two units lower. Distances of 2^22 and more are not measured. */
typedef uint32_t tear_bound;
static inline tear_bound tear_bound_of(int32_t rest, int32_t strain) {
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
static inline tear_bound tear_bound_of(int32_t rest, int32_t strain) {
  return link_stretched_squared(rest, strain);
}
static inline int is_within(vec3 d, tear_bound bound) { return vec_squared(d) <= bound; }
#endif

enum { KIND_NONE = 256 }; /* no spring's: kinds are bytes */

/* Out of line: springs of one kind follow one another. */
__attribute__((noinline)) static tear_bound tear_bound_of_class(const fray_world *w, int32_t rest) {
  return tear_bound_of(rest, w->params->tear_min);
}

static inline void test_spring(fray_world *w, uint32_t spring, vec3 d, int32_t rest) {
  FRAY_ASSERT(spring < (uint32_t)w->params->links);
  const uint64_t n = vec_squared(d);
  const uint64_t limit = link_stretched_squared(rest, world_tear_strain(w, spring));
  if (n <= limit || (world_has_yarns(w) && !ends_have_split(w, spring))) return;
  const torn_spring found = {spring, excess_over(n, limit)};
  tear_queue_push(w, found);
}

void spring_tear_find_range(fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(!world_has_membrane(w));
  FRAY_ASSERT(first <= end && end <= (uint32_t)w->params->links);
  const params *p = w->params;
  if (p->tearing == 0) return;
  const link_view view = woven_links(w);
  uint32_t kind = KIND_NONE;
  int32_t rest = 0;
  tear_bound bound = 0;
  for (uint32_t spring = first; spring < end; ++spring) {
    spring = simd_tear_scan(w->kernel, view, p->tear_min, spring, end);
    if (spring == end) break;
    if (view.kind[spring] != kind) {
      if (view.kind[spring] == SPRING_DEAD) continue;
      kind = view.kind[spring];
      rest = view.classes[kind & SPRING_CLASS].rest;
      bound = tear_bound_of_class(w, rest);
    }
    const vec3 d = vec_sub(world_position(w, view.j[spring]), world_position(w, view.i[spring]));
    if (!is_within(d, bound)) test_spring(w, spring, d, rest);
  }
  w->work.tear_tests += end - first;
  w->work.over_threshold += w->woven.tear_count + w->woven.tears_waiting;
}

void spring_tear_find(fray_world *w) {
  FRAY_ASSERT(w->woven.tear_count == 0 && w->woven.tears_waiting == 0);
  spring_tear_find_range(w, 0, (uint32_t)w->params->links);
}

uint32_t spring_tear_worst(const fray_world *w) {
  FRAY_ASSERT(w->woven.tear_count != 0);
  uint32_t worst = 0;
  for (uint32_t n = 1; n < w->woven.tear_count; ++n)
    if (tear_queue_before(w, &w->woven.tear_queue[n], &w->woven.tear_queue[worst])) worst = n;
  return w->woven.canonical_id[w->woven.tear_queue[worst].spring];
}
