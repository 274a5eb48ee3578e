/* SPDX-License-Identifier: Apache-2.0 */
/* Self-collision of the woven cloth: yarns do not pass through each other (Metaaphanon 2009, section
 * 4.2, equation 5; the response is ours, after Bridson et al. 2002). Segments of yarns are structural
 * links that are not broken; those that share a particle, or a crossing that holds its yarns together, are
 * left to the weave and to yarn slip.
 *
 * Once a tick, after its last substep, breaks and splits, and when velocities have followed: every particle
 * has moved on a straight path from where the tick began to where it is now. If nothing touches on these
 * paths at any time, no yarn has passed another, whatever the substeps did in between. So:
 *
 *   find    segments that may come near each other (yarn_collision_find.c)
 *   push    those that come nearer than the thickness, a few rounds; the speed at which they approach is
 *           removed; positions are moved without changing velocities (yarn_collision_pair.c)
 *   merge   those that touch on their paths nevertheless: both become one impact zone, which moves by
 *           its mean path from where the tick began, where they did not touch; a few rounds, then all
 *           pairs that are left
 *
 * If a particle is moved farther from its path's end than the slack that the search allowed for, the
 * pass is repeated. If the passes do not settle it, the whole cloth moves as one zone in this tick, and
 * FRAY_FAULT_SELF_COLLISION_BUDGET is set. That bit also says that the search met a bound: what it found
 * is pushed and merged as ever, what it left out may pass. A cloth that moved as one for that would be as
 * dense in the next tick, and never move again. A zone has one velocity, so that links which pull at it do
 * not give it more in each tick; momentum is conserved to the last bit. Behind the first passes projected
 * links bring the particles around to where their zones went (follow_zones()). All this comes behind what
 * changes velocities in a tick: an approach that something else has stopped is none. Attached particles
 * follow their bodies: bodies that carry yarns through each other are reported, not stopped. */
#include "rt/self_collision/yarn_collision.h"

#include "rt/self_collision/impact_zone_bodies.h"
#include "rt/self_collision/self_collision.h"
#include "rt/woven/woven.h"

#define COLLISION_PAIR self_pair

static inline uint32_t pair_count(const fray_world *w) { return w->yarn.pair_count; }
static inline self_pair *pair_at(const fray_world *w, uint32_t n) { return &w->yarn.pairs[n]; }
static inline uint32_t pair_particle(const fray_world *w, const self_pair *pair, uint32_t n) {
  const uint32_t spring = n < 2 ? pair->a : pair->b;
  return n % 2u == 0 ? w->woven.spring_i[spring] : w->woven.spring_j[spring];
}
static inline int pair_push(fray_world *w, self_pair *pair) { return yarn_collision_push(w, pair); }
static inline int pair_touches(fray_world *w, const self_pair *pair) {
  return yarn_collision_touches(w, pair);
}

static inline int lead_zones_out(fray_world *w) { return impact_zones_lead_out(w); }

#include "rt/self_collision/collision_passes.inl.h"

void yarn_collision_merge(fray_world *w, const self_pair *pair) { pair_merge(w, pair); }

void yarn_collision_begin(fray_world *w) {
  FRAY_ASSERT(world_has_yarn_collision(w));
  for (uint32_t p = 0; p < w->p.count; ++p) w->self.paths[p].begin = world_position(w, p);
  w->yarn.particles_before = w->p.count;
}

/* Particles that a split has made in this tick began where their crossing was. */
static void begin_new_particles(fray_world *w) {
  FRAY_ASSERT(w->yarn.particles_before <= w->p.count);
  for (uint32_t p = w->yarn.particles_before; p < w->p.count; ++p)
    w->self.paths[p].begin = w->self.paths[w->woven.crossing_particle[w->woven.crossing_of[p]]].begin;
}

static void hold_zones(fray_world *w) {
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    if (w->self.zones[impact_zones_of(w, p)].members < 2) continue;
    w->p.x[p] = w->self.paths[p].end.x;
    w->p.y[p] = w->self.paths[p].end.y;
    w->p.z[p] = w->self.paths[p].end.z;
  }
}

/* What hangs on a zone goes with it as links pull, by position alone: left behind, it would be drawn over the
 * way of a tick in a substep. Bodies are not drawn. */
static void follow_zones(fray_world *w) {
  const uint32_t sweeps = self_follow_sweeps((uint32_t)w->params->substeps);
  const uint32_t bodies = (uint32_t)w->params->bodies;
  int64_t impulse[MAX_BODIES][3];
  FRAY_ASSERT(bodies <= MAX_BODIES);
  for (uint32_t b = 0; b < bodies; ++b)
    for (uint32_t k = 0; k < 3; ++k) impulse[b][k] = w->rigid.motion[b].impulse[k];
  for (uint32_t p = 0; p < w->p.count; ++p) w->self.paths[p].end = world_position(w, p);
  for (uint32_t sweep = 0; sweep < sweeps; ++sweep) {
    strain_limit_apply(w);
    hold_zones(w);
    (void)impact_zones_lead_out(w);
  }
  for (uint32_t b = 0; b < bodies; ++b)
    for (uint32_t k = 0; k < 3; ++k) w->rigid.motion[b].impulse[k] = impulse[b][k];
}

void yarn_collision_solve(fray_world *w) {
  FRAY_ASSERT(world_has_yarn_collision(w));
  begin_new_particles(w);
  w->yarn.without_room = 0;
  w->yarn.bound_met = 0;
  for (w->yarn.pass = 0; w->yarn.pass < SELF_PASSES; ++w->yarn.pass) {
    impact_zones_begin(w);
    yarn_collision_find(w);
    if (w->yarn.pass == 0) (void)push_pairs(w);
    merge_pairs(w);
    impact_zones_average(w);
    impact_zones_stop(w);
    if (w->self.merged && w->yarn.pass < SELF_FOLLOWS && !world_has_elastic_yarns(w)) {
      follow_zones(w);
      continue; /* what followed may touch */
    }
    if (impact_zones_are_near(w) && w->yarn.moved_without_room == 0) return;
  }
  if (w->yarn.bound_met) return;
  impact_zones_join_all(w);
  impact_zones_average(w);
}
