/* SPDX-License-Identifier: Apache-2.0 */
/* Self-contact at the velocity, in each elastic step, as contact with bodies is
 * (contact/constraint_solve.c): two features that would come nearer than the thickness get opposite
 * impulses along their normal. That takes energy and keeps momentum, and cloth that lies on cloth
 * rests. Found once a tick, by the velocities with which it begins, and nothing of it is state:
 * what is missed is for triangle_collision_solve(). */
#include "rt/self_collision/self_constraints.h"

#include "rt/elastic/step_passive.h"
#include "rt/self_collision/impact_zones.h"
#include "rt/self_collision/self_collision.h"
#include "rt/self_collision/triangle_collision.h"

enum { WEIGHT_BITS = 15 };

/* ---- found ---- */

void self_constraint_add(fray_world *w, const uint32_t p[4], const int32_t weight[4], vec3 normal,
                         int64_t gap) {
  if (w->attempt.begin->constraints == SELF_CONSTRAINTS * w->capacity[POOL_PARTICLES]) return;
  self_constraint *c = &w->tri.constraints[w->attempt.begin->constraints++];
  for (uint32_t n = 0; n < 4; ++n) {
    c->p[n] = (index_t)p[n];
    c->weight[n] = weight[n];
  }
  c->normal = normal;
  c->gap_begin = fx_saturate(gap * (1 << FX_SUB_BITS));
}

static vec3 velocity_of(const fray_world *w, uint32_t p) {
  return particle_is_attached(w, p) ? world_body_velocity(w, w->p.attach_body[p])
                                    : world_velocity(w, p);
}

/* To where everything would be at the end of the tick. */
static void move_ahead(fray_world *w) {
  for (uint32_t p = 0; p < w->p.count; ++p) {
    const vec3 moved = vec_clamp(vec_round(velocity_of(w, p), FX_SUB_BITS), FX_WORLD_MAX / 256);
    const vec3 end =
        vec_add_clamped(world_position(w, p), vec_mul(moved, w->params->substeps), FX_EDGE_MAX);
    w->p.x[p] = end.x;
    w->p.y[p] = end.y;
    w->p.z[p] = end.z;
  }
}

static void move_back(fray_world *w) {
  for (uint32_t p = 0; p < w->p.count; ++p) {
    const vec3 begin = w->self.paths[p].begin;
    w->p.x[p] = begin.x;
    w->p.y[p] = begin.y;
    w->p.z[p] = begin.z;
  }
}

void self_constraints_find(fray_world *w) {
  const int32_t faults = w->state->faults;
  FRAY_ASSERT(world_has_triangle_collision(w));
  w->attempt.begin->constraints = 0;
  move_ahead(w);
  impact_zones_begin(w);
  w->tri.list->without_room = UINT32_MAX; /* nothing is merged by these paths */
  if (triangle_collision_find(w, 1))
    for (uint32_t n = 0; n < w->tri.list->active; ++n)
      triangle_collision_constrain(w, &w->tri.pairs[w->tri.active[n]]);
  move_back(w);
  w->state->faults = faults; /* what has no room here is found again behind the steps */
}

/* ---- solved ---- */

static int is_within_zone(const fray_world *w, const self_constraint *c) {
  const self_zone *zone = step_zone_of(w, c->p[0]);
  return zone != NULL && step_zone_of(w, c->p[1]) == zone && step_zone_of(w, c->p[2]) == zone &&
         step_zone_of(w, c->p[3]) == zone;
}

void self_constraints_begin(fray_world *w) {
  uint32_t kept = 0;
  FRAY_ASSERT(w->attempt.begin->constraints <= SELF_CONSTRAINTS * w->capacity[POOL_PARTICLES]);
  for (uint32_t n = 0; n < w->attempt.begin->constraints; ++n) {
    self_constraint *c = &w->tri.constraints[n];
    const uint32_t vertex[4] = {c->p[0], c->p[1], c->p[2], c->p[3]};
    const uint64_t k = step_point_inverse_mass(w, vertex, c->weight, 4);
    if (k == 0 || is_within_zone(w, c)) continue; /* for good: zones only grow in a tick */
    c->mass = step_mass_of(k);
    c->gap = c->gap_begin;
    c->low = 0;
    w->tri.constraints[kept++] = *c;
  }
  w->attempt.begin->constraints = kept;
}

static vec3 weighted(const self_constraint *c, const vec3 of[4]) {
  vec64 sum = {0, 0, 0};
  for (uint32_t n = 0; n < 4; ++n) sum = vec_add64(sum, vec_scale64(of[n], c->weight[n]));
  return vec_round_saturated(sum, WEIGHT_BITS);
}

static vec3 relative_velocity(const fray_world *w, const self_constraint *c,
                              const elastic_step *step) {
  const vec3 of[4] = {step_velocity(w, c->p[0], step), step_velocity(w, c->p[1], step),
                      step_velocity(w, c->p[2], step), step_velocity(w, c->p[3], step)};
  return weighted(c, of);
}

static vec3 relative_half(const fray_world *w, const self_constraint *c, const elastic_step *step) {
  const vec3 of[4] = {step_half_of(w, c->p[0], step), step_half_of(w, c->p[1], step),
                      step_half_of(w, c->p[2], step), step_half_of(w, c->p[3], step)};
  return weighted(c, of);
}

static void push_apart(fray_world *w, const self_constraint *c, vec3 change) {
  const vec64 whole = step_impulse_of(c->mass, change);
  for (uint32_t n = 0; n < 4; ++n) {
    const vec64 share = {fx_round64(whole.x * c->weight[n], WEIGHT_BITS),
                         fx_round64(whole.y * c->weight[n], WEIGHT_BITS),
                         fx_round64(whole.z * c->weight[n], WEIGHT_BITS)};
    if (c->weight[n] != 0) (void)step_push(w, c->p[n], share);
  }
}

static void solve_constraint(fray_world *w, self_constraint *c, const elastic_step *step) {
  const vec3 velocity = relative_velocity(w, c, step);
  const int32_t least = step_speed_min(c->gap, w->membrane.constants->steps, step->rise);
  int32_t along = vec_dot_unit(velocity, c->normal);
  if (along < least) {
    const int32_t half = vec_dot_unit(relative_half(w, c, step), c->normal);
    const int32_t to = step_passive_speed(least, along, half);
    push_apart(w, c, vec_scale_unit(c->normal, fx_saturate((int64_t)to - along)));
    along = to;
  }
  const int64_t way = fx_mul_wide(along, step->part) + c->low;
  c->low = (int32_t)(way & INT32_MAX);
  c->gap = fx_saturate(c->gap + fx_asr64(way, ELASTIC_LOW_BITS));
}

void self_constraints_solve(fray_world *w, const elastic_step *step) {
  if (!world_has_triangle_collision(w)) return;
  self_constraint *c = w->tri.constraints;
  FRAY_ASSERT(w->attempt.begin->constraints <= SELF_CONSTRAINTS * w->capacity[POOL_PARTICLES]);
  for (uint32_t n = 0; n < w->attempt.begin->constraints; ++n) solve_constraint(w, &c[n], step);
  w->work.contact_constraints += w->attempt.begin->constraints;
}
