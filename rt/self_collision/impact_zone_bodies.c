/* SPDX-License-Identifier: Apache-2.0 */
/* A zone goes back by the way of a tick, and a push moves yarns by up to a thickness: both may end in a body
 * that contact kept them out of. Put out particle by particle, in the next tick, the zone would come back as
 * often, and what weighs on it would press it in. So it meets bodies as one particle of its mass: it is led
 * out by position, and stops, without restitution. Each contact sees what those before it did. */
#include "rt/self_collision/impact_zone_bodies.h"

#include "rt/contact/shape.h"
#include "rt/elastic/step_impulse.h"
#include "rt/self_collision/impact_zones.h"

static self_zone *zone_of(fray_world *w, const contact *c) {
  return &w->self.zones[impact_zones_of(w, c->particle)];
}

static int32_t depth_of(const fray_world *w, const contact *c, vec3 at, int32_t skin, vec3 *normal) {
  const vec3 d = vec_sub(at, vec_of(w->rigid.states[c->body].position));
  return shape_depth_at(&w->rigid.bodies[c->body], d, skin, normal);
}

/* `sum` of a zone: how far it is led out, Q24 lu; then what stops it, Q28 lu per substep. */
static vec3 sum_of(const self_zone *z) {
  return vec_make((int32_t)z->sum[0], (int32_t)z->sum[1], (int32_t)z->sum[2]);
}

static void set_sum(self_zone *z, vec3 sum) {
  z->sum[0] = sum.x;
  z->sum[1] = sum.y;
  z->sum[2] = sum.z;
}

static void clear_sums(fray_world *w) {
  for (uint32_t p = 0; p < w->p.count; ++p) set_sum(&w->self.zones[p], vec_make(0, 0, 0));
}

/* ---- positions ---- */

/* Returns 1 iff it moves the zone. */
static int lead_out(fray_world *w, const contact *c) {
  const int32_t skin = w->params->thickness;
  const vec3 end = w->self.paths[c->particle].end;
  self_zone *z = zone_of(w, c);
  const vec3 at = vec_add_clamped(world_position(w, c->particle), sum_of(z), FX_EDGE_MAX);
  vec3 normal;
  if (vec_is_equal(at, end)) return 0;
  ++w->work.self_ccd;
  const int32_t before = depth_of(w, c, end, skin, &normal);
  const int32_t depth = depth_of(w, c, at, skin, &normal);
  if (depth <= before) return 0;
  if (z->held != SELF_NONE) {
    if (depth > skin) world_fault(w, FRAY_FAULT_CONTACT_UNRESOLVED);
    return 0;
  }
  const vec3 out = vec_scale_unit(normal, depth - before);
  set_sum(z, vec_add_clamped(sum_of(z), out, FX_WORLD_MAX));
  return 1;
}

int impact_zones_lead_out(fray_world *w) {
  FRAY_ASSERT(world_has_yarn_collision(w) && w->contact.gathered <= w->contact.count);
  int led = 0;
  if (w->contact.gathered == 0) return 0;
  clear_sums(w);
  for (uint32_t p = 0; p < w->p.count; ++p) w->self.zones[p].held = SELF_NONE;
  for (uint32_t p = 0; p < particles_attached(w); ++p) w->self.zones[impact_zones_of(w, p)].held = p;
  for (uint32_t n = 0; n < w->contact.gathered; ++n) led |= lead_out(w, &w->contact.list[n]);
  for (uint32_t p = particles_attached(w); led && p < w->p.count; ++p) {
    const vec3 by = sum_of(&w->self.zones[impact_zones_of(w, p)]);
    if (vec_span(by) != 0) impact_zones_shift(w, p, by);
  }
  return led;
}

/* ---- velocities ---- */

enum { ZONE_SPEED_STEP = 8 };

/* Of a change of its velocity relative to the body: what the zone gains, whole for a driven body. */
static vec3 share_of(const fray_world *w, const self_zone *z, uint32_t b, vec3 change) {
  enum { BITS = 30 };
  const int64_t inverse = ((int64_t)2 << BITS) / z->mass;
  const int64_t sum = inverse + w->rigid.bodies[b].mass_ratio;
  return vec_round_saturated(vec_scale64(change, (int32_t)((inverse << (BITS - 1)) / sum)), BITS - 1);
}

/* A speed whose momentum, of whole half crossings, is a whole number in Q26. */
static int32_t whole(int32_t v) { return v / ZONE_SPEED_STEP; }

static void stop(fray_world *w, const contact *c) {
  enum { NEAR = 16 }; /* of the thickness: as good as touching */
  const uint32_t b = c->body;
  const int32_t skin = w->params->thickness + w->params->thickness / NEAR;
  self_zone *z = zone_of(w, c);
  vec3 normal;
  if (z->members < 2 || z->held != SELF_NONE) return;
  ++w->work.self_ccd;
  if (depth_of(w, c, world_position(w, c->particle), skin, &normal) <= 0) return;
  const vec3 velocity = vec_add_clamped(world_velocity(w, c->particle), sum_of(z), INT32_MAX);
  const vec3 relative = vec_sub_saturated(velocity, vec_of(w->rigid.states[b].velocity));
  const vec3 change = step_contact_change(relative, normal, 0, w->rigid.bodies[b].friction);
  if (vec_span(change) == 0) return;
  const vec3 share = share_of(w, z, b, change);
  const vec3 gained = vec_make(whole(share.x), whole(share.y), whole(share.z));
  set_sum(z, vec_add_clamped(sum_of(z), vec_mul(gained, ZONE_SPEED_STEP), FX_SPEED_MAX));
  step_push_body(w, b, vec_scale64(gained, z->mass));
}

void impact_zones_stop(fray_world *w) {
  if (!w->self.merged || w->contact.gathered == 0) return;
  clear_sums(w);
  for (uint32_t n = 0; n < w->contact.gathered; ++n) stop(w, &w->contact.list[n]);
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    const vec3 by = sum_of(&w->self.zones[impact_zones_of(w, p)]);
    if (vec_span(by) != 0) world_set_velocity(w, p, vec_add_clamped(world_velocity(w, p), by, FX_SPEED_MAX));
  }
}
