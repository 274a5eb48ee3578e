/* SPDX-License-Identifier: Apache-2.0 */
/* A zone that is put together behind the elastic steps takes its vertices back along paths that
 * their neighbours have gone: that stores k d^2 / 2 in the triangles between. So the tick is done
 * again with its vertices as one: in each elastic step they have the mean velocity, or that of the
 * body that holds one. Of all motions that agree within the zone it is the nearest, by masses; so
 * it takes kinetic energy, and no frequency of the cloth rises by it (Rayleigh). What acts on one of
 * them in a step acts on the zone and its mass (elastic/step_zone.h).
 *
 * Leapfrog has velocities half a step from positions, and forces go on within a zone. With c half of
 * what they change of a velocity in a step, v + c is the velocity where a tick ends. What acts there,
 * behind the elastic steps, sees that one; and a zone leaves its vertices alike in v + c, not in v,
 * which would be a kinetic energy out of nothing. */
#include "rt/self_collision/impact_zone_steps.h"

#include "rt/elastic/step_passive.h"
#include "rt/self_collision/impact_zones.h"
#include "rt/state/vertex_mass.h"

enum { MASS_MAX = 1 << 24, MASS_BITS = VERTEX_MASS_BITS };

static int has_zones(const fray_world *w) {
  return world_repeats_ticks(w) && w->attempt.begin->joined_any != 0;
}

static int32_t mass_of(const vertex_mass_scale *scale, uint32_t p) {
  return fx_clamp(vertex_mass_at(scale, p), 1, MASS_MAX);
}

/* ---- zones of an attempt ---- */

/* Of self-collision its root; else that of its body, or the last, which has no member. */
static uint32_t zone_of(fray_world *w, uint32_t p) {
  const uint32_t body = w->attempt.vertices[p].joined_body;
  if (world_has_triangle_collision(w)) return impact_zones_joined(w, p);
  return body != 0 ? body - 1u : world_zones(w) - 1u;
}

static void find_members(fray_world *w, const vertex_mass_scale *scale, uint32_t p) {
  attempt_vertex *v = &w->attempt.vertices[p];
  v->joined = (index_t)zone_of(w, p);
  self_zone *z = &w->self.zones[v->joined];
  if (v->joined == world_zones(w) - 1u) return;
  ++z->members;
  if (!particle_is_attached(w, p)) z->whole += mass_of(scale, p);
  if (z->held != STEP_NO_BODY) return;
  if (particle_is_attached(w, p))
    z->held = w->p.attach_body[p];
  else if (v->joined_body != 0)
    z->held = v->joined_body - 1u;
}

void impact_zone_steps_begin(fray_world *w) {
  static const self_zone empty = {{0, 0, 0}, 0, {0, 0, 0}, {0, 0, 0}, 0, 0, 0, STEP_NO_BODY};
  const vertex_mass_scale scale = vertex_mass_scale_of(w);
  if (!has_zones(w)) return;
  for (uint32_t n = 0; n < world_zones(w); ++n) w->self.zones[n] = empty;
  for (uint32_t p = 0; p < w->p.count; ++p) find_members(w, &scale, p);
  for (uint32_t n = 0; n < world_zones(w); ++n) {
    self_zone *z = &w->self.zones[n];
    if (z->whole != 0)
      z->inverse_mass = (uint32_t)fx_clamp64(((int64_t)1 << 40) / z->whole, 0, INT32_MAX);
  }
}

void impact_zone_steps_leave_edges(fray_world *w) {
  uint32_t kept = 0;
  limited_edge *edges = w->membrane.limited_edges;
  if (!has_zones(w)) return;
  for (uint32_t n = 0; n < w->membrane.limited_edge_count; ++n) {
    const self_zone *zone = step_zone_of(w, edges[n].i);
    if (zone == NULL || zone != step_zone_of(w, edges[n].j)) edges[kept++] = edges[n];
  }
  w->membrane.limited_edge_count = kept;
}

/* ---- means ---- */

/* Of what zones have a mean. */
typedef enum {
  ZONE_VELOCITY, /* behind all impulses so far */
  ZONE_FORCED    /* half of what the forces of a step change of it */
} zone_quantity;

static vec3 of_vertex(const fray_world *w, uint32_t p, const elastic_step *step, zone_quantity q) {
  return q == ZONE_VELOCITY ? step_vertex_velocity(w, p, step) : step_vertex_half_of(w, p, step);
}

static vec3 of_body(const fray_world *w, uint32_t b, zone_quantity q) {
  return q == ZONE_VELOCITY ? step_body_velocity(w, b) : step_body_half_of(w, b);
}

/* Which zones. */
typedef enum {
  ALL_ZONES,
  FREE_BODIES_ZONES /* these bodies take impulses alone, and their zones follow */
} zone_choice;

static int is_chosen(const fray_world *w, const self_zone *z, zone_choice of) {
  if (of == ALL_ZONES) return z->whole != 0;
  return z->whole != 0 && z->held != STEP_NO_BODY && !body_is_driven(&w->rigid.bodies[z->held]);
}

/* Adds a vertex to its zone, as seen from the zone's body. */
static void sum_vertex(fray_world *w, self_zone *z, uint32_t p, int32_t mass, const elastic_step *step,
                       zone_quantity q) {
  const vec3 v = vec_sub_saturated(of_vertex(w, p, step, q), of_body(w, z->held, q));
  z->sum[0] += fx_round64(fx_mul_wide(v.x, mass), MASS_BITS);
  z->sum[1] += fx_round64(fx_mul_wide(v.y, mass), MASS_BITS);
  z->sum[2] += fx_round64(fx_mul_wide(v.z, mass), MASS_BITS);
}

/* Sum over mass, Q28 over Q16. */
static int32_t mean_of(int64_t sum, int64_t mass) {
  const int64_t whole = sum / mass;
  const int64_t rest = sum - whole * mass;
  return fx_saturate(whole * (1 << MASS_BITS) + rest * (1 << MASS_BITS) / mass);
}

/* With a free body that of their common mass. */
static void find_mean(const fray_world *w, self_zone *z, zone_quantity q) {
  enum { BODY_MASS_MAX_BITS = 46 };
  const vec3 body = of_body(w, z->held, q);
  const int32_t begin[3] = {body.x, body.y, body.z};
  const int32_t ratio = z->held == STEP_NO_BODY ? 0 : w->rigid.bodies[z->held].mass_ratio;
  int32_t *mean = q == ZONE_VELOCITY ? z->mean : z->half;
  int64_t mass = z->whole;
  if (ratio != 0) mass += ((int64_t)1 << BODY_MASS_MAX_BITS) / ratio;
  for (uint32_t k = 0; k < 3; ++k) {
    const int32_t gained = z->held != STEP_NO_BODY && ratio == 0 ? 0 : mean_of(z->sum[k], mass);
    mean[k] = fx_add_saturated(begin[k], gained);
  }
}

static void find_means(fray_world *w, const elastic_step *step, zone_quantity q, zone_choice of) {
  const vertex_mass_scale scale = vertex_mass_scale_of(w);
  for (uint32_t n = 0; n < world_zones(w); ++n)
    w->self.zones[n].sum[0] = w->self.zones[n].sum[1] = w->self.zones[n].sum[2] = 0;
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    self_zone *z = &w->self.zones[w->attempt.vertices[p].joined];
    if (is_chosen(w, z, of)) sum_vertex(w, z, p, mass_of(&scale, p), step, q);
  }
  for (uint32_t n = 0; n < world_zones(w); ++n)
    if (is_chosen(w, &w->self.zones[n], of)) find_mean(w, &w->self.zones[n], q);
}

/* ---- a step ---- */

static int64_t impulse_of(int32_t change, int32_t inverse) {
  enum { UP = ELASTIC_IMPULSE_BITS + ELASTIC_INVERSE_BITS - FX_VELOCITY_BITS };
  return (int64_t)change * (1 << UP) / inverse;
}

static vec64 impulse_for(vec3 change, int32_t inverse) {
  const vec64 impulse = {impulse_of(change.x, inverse), impulse_of(change.y, inverse),
                         impulse_of(change.z, inverse)};
  return impulse;
}

static void push_vertex(fray_world *w, uint32_t p, const self_zone *z, const elastic_step *step) {
  const vec3 change = vec_sub_saturated(vec_of(z->mean), step_vertex_velocity(w, p, step));
  const int32_t inverse = w->membrane.inverse_mass[p];
  if (vec_span(change) == 0 || inverse == 0) return;
  step_push_body(w, z->held, step_push_vertex(w, p, impulse_for(change, inverse)));
}

static void push_vertices(fray_world *w, const elastic_step *step) {
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    const self_zone *z = step_zone_of(w, p);
    if (z != NULL) push_vertex(w, p, z, step);
  }
}

void impact_zone_steps_hold(fray_world *w, const elastic_step *step) {
  if (!has_zones(w)) return;
  find_means(w, step, ZONE_FORCED, ALL_ZONES);
  find_means(w, step, ZONE_VELOCITY, ALL_ZONES);
  push_vertices(w, step);
}

void impact_zone_steps_share(fray_world *w, const elastic_step *step) {
  if (!has_zones(w)) return;
  find_means(w, step, ZONE_VELOCITY, FREE_BODIES_ZONES);
  push_vertices(w, step);
}

/* ---- the end of a tick ---- */

static int acts_at_end(const fray_world *w) { return world_has_triangle_collision(w) || has_zones(w); }

static elastic_step last_step_of(const fray_world *w) {
  const int32_t steps = w->membrane.constants->steps;
  const elastic_step last = {{step_part_of(w->gravity_step.x, steps - 1, steps),
                              step_part_of(w->gravity_step.y, steps - 1, steps),
                              step_part_of(w->gravity_step.z, steps - 1, steps)},
                             0, 0};
  return last;
}

static void set_velocity(fray_world *w, uint32_t p, vec3 velocity) {
  const vec3 clamped = vec_clamp(velocity, FX_SPEED_MAX);
  if (!vec_is_equal(clamped, velocity)) world_fault(w, FRAY_FAULT_SPEED_LIMIT);
  world_set_velocity(w, p, clamped);
}

/* Half of what the forces change of a vertex itself, whatever its zone has. */
static vec3 own_half_of(const fray_world *w, uint32_t p, const elastic_step *last) {
  return particle_is_attached(w, p) ? step_body_half_of(w, w->p.attach_body[p])
                                    : step_vertex_half_of(w, p, last);
}

/* Where it ends, a zone gives each vertex its own half again. By masses that adds up to nothing; where a body
 * holds the zone, the body has the rest. */
static void part_from_body(fray_world *w, uint32_t p, vec3 half, const elastic_step *last) {
  const self_zone *z = step_zone_of(w, p);
  const int32_t inverse = w->membrane.inverse_mass[p];
  if (z == NULL || z->held == STEP_NO_BODY || inverse == 0) return;
  step_push_body(w, z->held, impulse_for(vec_sub_saturated(half, own_half_of(w, p, last)), inverse));
}

void impact_zone_steps_ahead(fray_world *w) {
  if (!acts_at_end(w)) return;
  const elastic_step last = last_step_of(w);
  for (uint32_t p = 0; p < w->p.count; ++p) {
    const vec3 half = step_half_of(w, p, &last);
    set_velocity(w, p, vec_add_clamped(world_velocity(w, p), half, INT32_MAX));
    if (!particle_is_attached(w, p)) part_from_body(w, p, half, &last);
  }
}

void impact_zone_steps_back(fray_world *w) {
  if (!acts_at_end(w)) return;
  const elastic_step last = last_step_of(w);
  for (uint32_t p = 0; p < w->p.count; ++p)
    set_velocity(w, p, vec_sub_saturated(world_velocity(w, p), own_half_of(w, p, &last)));
}
