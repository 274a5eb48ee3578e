/* SPDX-License-Identifier: Apache-2.0 */
/* Links that are drawn beyond what projections give back. Contact comes behind them, so a body in a link's
 * way wins: links grew to 40 times their length, and threw their particles at 30 m/s when it let go. So
 * bodies and meshes let the ends of one half as long again pass for a tick, and a fault says so; where links
 * tear, at twice the strain at which the strongest does. Lengths are measured in units of 2^LINK_SHIFT, to
 * 1/4 lu. */
#include "rt/base/bytes.h"
#include "rt/simd/simd.h"
#include "rt/woven/woven.h"
#include "rt/woven/woven_links.h"

enum { STRAIN_LEAST = 1 << 15, STRAIN_MOST = 1 << 18 }; /* Q16 */

int overstretched_links_may_be(const fray_world *w) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->rigid.bodies[b].shape != FRAY_ANCHOR || w->rigid.bodies[b].motion != FRAY_FIXED) return 1;
  return 0;
}

static int32_t strain_of(const params *p) {
  return p->tearing == 0 ? STRAIN_LEAST : fx_clamp(2 * p->tear_max, STRAIN_LEAST, STRAIN_MOST);
}

/* Out of line: links of one kind follow one another. */
__attribute__((noinline)) static uint32_t overstretched_bound(int32_t rest, int32_t strain) {
  const uint32_t length = link_stretched(rest, strain) >> LINK_SHIFT;
  return length < LINK_HI_MAX ? length * length : (uint32_t)(LINK_HI_MAX * LINK_HI_MAX);
}

static inline uint32_t squared_of(vec3 d) {
  const vec3 hi = vec_clamp_rare(vec_asr(d, LINK_SHIFT), LINK_HI_MAX);
  return (uint32_t)(fx_mul(hi.x, hi.x) + fx_mul(hi.y, hi.y) + fx_mul(hi.z, hi.z));
}

/* Returns 1 iff there are any. */
static int release_ends(fray_world *w) {
  const uint32_t end = (uint32_t)w->params->links;
  const int32_t strain = strain_of(w->params);
  const link_view view = woven_links(w);
  uint8_t *released = world_released(w);
  uint32_t kind = SPRING_DEAD;
  uint32_t bound = 0;
  int any = 0;
  for (uint32_t spring = 0; spring < end; ++spring) {
    spring = simd_tear_scan(w->kernel, view, strain, spring, end);
    if (spring == end) break;
    if (view.kind[spring] == SPRING_DEAD) continue;
    if (view.kind[spring] != kind) {
      kind = view.kind[spring];
      bound = overstretched_bound(view.classes[kind & SPRING_CLASS].rest, strain);
    }
    if (squared_of(link_vec(&view, view.i[spring], view.j[spring])) < bound) continue;
    released[view.i[spring]] = CONTACT_RELEASED;
    released[view.j[spring]] = CONTACT_RELEASED;
    any = 1;
  }
  return any;
}

void overstretched_links_apply(fray_world *w) {
  FRAY_ASSERT(world_is_projected(w));
  if (!overstretched_links_may_be(w)) return;
  bytes_zero(world_released(w), w->p.count);
  if (release_ends(w)) tethers_apply(w);
}
