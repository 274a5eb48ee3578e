/* SPDX-License-Identifier: Apache-2.0 */
/* Self-collision of the membrane: triangles do not pass through each other (Karaoz 2015, section 2.6;
 * the response is that of yarn_collision.c). Once a tick, after everything else: every vertex has moved
 * on a straight path from where the tick began to where it is now. If nothing touches on these paths,
 * nothing has passed. So:
 *
 *   find    pairs of a vertex and a triangle, and of two edges, that may come near each other
 *           (triangle_collision_find.c, triangle_collision_test.c)
 *   push    those that come nearer than the thickness, a few rounds: what is left of their approach is
 *           taken by an impulse that conserves momentum to the last bit (triangle_collision_pair.c)
 *   merge   those that touch on their paths nevertheless: their vertices become one impact zone
 *
 * Before, in the elastic steps, those that may meet are constraints (self_constraints.c), so that little
 * is left here. Zones that this finds, and vertices that a body stops, move as one from the beginning in
 * the next attempt at the tick (impact_zone_steps.c, tick/tick_membrane.c). Before the last but one all
 * pairs that may meet are joined, before the last all of the cloth; what that one finds is put together
 * by position.
 *
 * If a zone moves farther than the search allowed for, the pass is repeated. Then changed paths are
 * tested against rigid meshes and spheres again: a vertex that would cross a body is pinned to
 * that body, and its impact zone moves with it. If the passes do not settle it, the whole cloth moves as
 * one zone, and FRAY_FAULT_SELF_COLLISION_BUDGET is set.
 *
 * A tear makes two vertices in one position, where nothing tells their sides apart. Until they are a
 * thickness apart they count as the one vertex that they were. */
#include "rt/self_collision/triangle_collision.h"

#include "rt/contact/contact.h"
#include "rt/self_collision/patches.h"
#include "rt/self_collision/self_collision.h"

#define COLLISION_PAIR triangle_pair

static inline uint32_t pair_count(const fray_world *w) { return w->tri.list->active; }
static inline triangle_pair *pair_at(const fray_world *w, uint32_t n) {
  FRAY_ASSERT(w->tri.active[n] < w->tri.list->pairs);
  return &w->tri.pairs[w->tri.active[n]];
}
static inline uint32_t pair_particle(const fray_world *w, const triangle_pair *pair, uint32_t n) {
  (void)w;
  return pair->p[n];
}
static inline int pair_push(fray_world *w, triangle_pair *pair) { return triangle_collision_push(w, pair); }
static inline int pair_touches(fray_world *w, const triangle_pair *pair) {
  return triangle_collision_touches(w, pair);
}
static inline int lead_zones_out(fray_world *w) {
  (void)w; /* bodies pin vertices behind a pass */
  return 0;
}

#include "rt/self_collision/collision_passes.inl.h"

void triangle_collision_merge(fray_world *w, const triangle_pair *pair) { pair_merge(w, pair); }

void triangle_collision_begin(fray_world *w) {
  FRAY_ASSERT(world_has_triangle_collision(w));
  patches_advance(w);
  for (uint32_t p = 0; p < w->p.count; ++p) w->self.paths[p].begin = world_position(w, p);
}

/* Tests changed paths against bodies. The predicted position of a pinned vertex moves with it, so that
 * its velocity does not change. Returns 1 iff a vertex was pinned. */
static int pin_to_bodies(fray_world *w) {
  int pinned = 0;
  if (!world_has_rigid_meshes(w)) return 0;
  for (uint32_t p = 0; p < w->p.count; ++p) w->self.paths[p].end = world_position(w, p);
  if (!contact_vertices_check(w)) return 0;
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    const vec3 was = w->self.paths[p].end;
    const vec3 at = world_position(w, p);
    if (vec_is_equal(at, was)) continue;
    world_shift_predicted(w, p, vec_sub(at, was));
    w->attempt.vertices[p].pinned = 1;
    pinned = 1;
  }
  return pinned;
}

/* The last resort: the whole cloth moves by its mean, or as a pinned vertex does. */
static void merge_all(fray_world *w) {
  impact_zones_join_all(w);
  impact_zones_average(w);
  if (!pin_to_bodies(w)) return;
  impact_zones_move(w);
  if (pin_to_bodies(w)) world_fault(w, FRAY_FAULT_CONTACT_UNRESOLVED);
}

static void solve(fray_world *w) {
  w->tri.list->without_room = 0;
  for (uint32_t pass = 0; pass < SELF_PASSES; ++pass) {
    impact_zones_begin(w);
    if (!triangle_collision_find(w, 0)) break;
    if (pass == 0) (void)push_pairs(w);
    merge_pairs(w);
    impact_zones_average(w);
    if (w->self.merged == 0) return;
    impact_zones_keep(w);
    if (impact_zones_are_near(w) && w->tri.list->merged_without_room == 0 && !pin_to_bodies(w)) return;
  }
  merge_all(w);
}

void triangle_collision_solve(fray_world *w) {
  FRAY_ASSERT(world_has_triangle_collision(w));
  solve(w);
  impact_zones_keep(w);
}

void triangle_collision_widen(fray_world *w, uint32_t left) {
  FRAY_ASSERT(world_has_triangle_collision(w));
  if (left > 2) return;
  if (left == 1) impact_zones_keep_all(w);
  for (uint32_t n = 0; n < pair_count(w); ++n)
    for (uint32_t k = 1; k < 4; ++k)
      impact_zones_keep_pair(w, pair_particle(w, pair_at(w, n), 0), pair_particle(w, pair_at(w, n), k));
}
