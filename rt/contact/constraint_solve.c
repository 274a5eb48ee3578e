/* SPDX-License-Identifier: Apache-2.0 */
/* Contact of a membrane and bodies at the velocity, in each elastic step. A point that would pass
 * its plane in this step gets the impulse along the normal that stops it there, and friction within
 * the Coulomb cone. Sequential impulses: each sees those before it, and none makes energy
 * (elastic/step_passive.h). Out of an overlap a point goes at STEP_RISE_UM_S. */
#include "rt/contact/constraints.h"
#include "rt/contact/shape.h"
#include "rt/elastic/step_passive.h"
#include "rt/geometry/closest_point.h"

enum { WEIGHT_BITS = 15 };

static vec3 point_velocity(const fray_world *w, const contact_constraint *c,
                           const elastic_step *step) {
  vec64 sum = {0, 0, 0};
  if (c->weight[0] == CONSTRAINT_ONE) return step_velocity(w, c->vertex[0], step);
  for (uint32_t k = 0; k < 3; ++k)
    if (c->weight[k] != 0)
      sum = vec_add64(sum, vec_scale64(step_velocity(w, c->vertex[k], step), c->weight[k]));
  return vec_round_saturated(sum, WEIGHT_BITS);
}

static vec3 half_of(const fray_world *w, const contact_constraint *c, const elastic_step *step) {
  vec64 sum = {0, 0, 0};
  for (uint32_t k = 0; k < 3; ++k)
    if (c->weight[k] != 0)
      sum = vec_add64(sum, vec_scale64(step_half_of(w, c->vertex[k], step), c->weight[k]));
  return vec_sub_saturated(vec_round_saturated(sum, WEIGHT_BITS), step_body_half_of(w, c->body));
}

static void push_point(fray_world *w, const contact_constraint *c, vec3 change) {
  const vec64 whole = step_impulse_of(c->mass, change);
  vec64 taken = {0, 0, 0};
  for (uint32_t k = 0; k < 3; ++k) {
    if (c->weight[k] == 0) continue;
    const vec64 share = {fx_round64(whole.x * c->weight[k], WEIGHT_BITS),
                         fx_round64(whole.y * c->weight[k], WEIGHT_BITS),
                         fx_round64(whole.z * c->weight[k], WEIGHT_BITS)};
    taken = vec_add64(taken, step_push(w, c->vertex[k], share));
  }
  step_push_body(w, c->body, taken);
}

/* ---- planes that turn ---- */

contact_way_out contact_way_out_of(const fray_world *w, uint32_t b, uint32_t p) {
  const elastic_body *body = &w->membrane.bodies[b];
  FRAY_ASSERT(b < w->capacity[POOL_BODIES] && p < w->p.count);
  const vec3 start = vec_sub(world_position(w, p), body->start);
  const vec3 began =
      vec_make(fx_wrap_shift(start.x, FX_SUB_BITS), fx_wrap_shift(start.y, FX_SUB_BITS),
               fx_wrap_shift(start.z, FX_SUB_BITS));
  const vec3 now = vec_wrap_sub(vec_of(w->membrane.positions[p].at), vec_of(body->at));
  const vec3 moved = vec_wrap_sub(now, began);
  const contact_way_out out = {vec_add_clamped(start, vec_asr(moved, FX_SUB_BITS), 2 * FX_WORLD_MAX),
                       vec_make(moved.x & 15, moved.y & 15, moved.z & 15)};
  return out;
}

static int32_t to_q28(int64_t gap) { return fx_saturate(gap * (1 << FX_SUB_BITS)); }

/* The primitive's own plane for a vertex. */
static void turn_vertex(const fray_world *w, contact_constraint *c) {
  const contact_way_out out = contact_way_out_of(w, c->body, c->vertex[0]);
  const int32_t margin = w->params->contact_margin;
  const int32_t depth = shape_depth_at(&w->rigid.bodies[c->body], out.whole,
                                    fx_add(w->params->thickness, margin), &c->normal);
  c->gap = depth <= 0 ? to_q28(margin)
                      : fx_saturate((int64_t)to_q28((int64_t)margin - depth) +
                                    vec_dot_unit(out.rest, c->normal));
}

static closest_face face_of(const contact_way_out corner[3]) {
  const vec3 a = vec_sub(corner[1].whole, corner[0].whole);
  const vec3 b = vec_sub(corner[2].whole, corner[0].whole);
  const unsigned s = closest_excess(
      closest_span(corner[0].whole) | closest_span(a) | closest_span(b), CLOSEST_BITS);
  const closest_face face = {closest_shifted(corner[0].whole, s), closest_shifted(a, s),
                             closest_shifted(b, s)};
  return face;
}

static vec3 weighted(const int32_t weight[3], vec3 a, vec3 b, vec3 c) {
  const vec64 ab = vec_add64(vec_scale64(a, weight[0]), vec_scale64(b, weight[1]));
  return vec_round_saturated(vec_add64(ab, vec_scale64(c, weight[2])), WEIGHT_BITS);
}

/* A sphere's plane for a triangle: through the point of it that is nearest to the centre. */
static void turn_triangle(const fray_world *w, contact_constraint *c) {
  contact_way_out corner[3];
  for (uint32_t k = 0; k < 3; ++k) corner[k] = contact_way_out_of(w, c->body, c->vertex[k]);
  const closest_face face = face_of(corner);
  const closest_point nearest = closest_point_find(&face, CLOSEST_TRIANGLE);
  const int32_t of_b = closest_weight(&nearest, 0);
  const int32_t of_c = closest_weight(&nearest, 1);
  const int32_t weight[3] = {fx_max(0, CONSTRAINT_ONE - of_b - of_c), of_b, of_c};
  const vec3 at = weighted(weight, corner[0].whole, corner[1].whole, corner[2].whole);
  const uint64_t squared = vec_squared(at);
  if (squared == 0) return;
  const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
  const vec3 normal = vec_root_unit(root, at);
  if (vec_dot64(normal, c->normal) <= 0)
    return; /* it has passed the centre: the side of before counts */
  const vec3 rest = weighted(weight, corner[0].rest, corner[1].rest, corner[2].rest);
  const int64_t reach = (int64_t)w->rigid.bodies[c->body].radius + w->params->thickness;
  c->normal = normal;
  for (uint32_t k = 0; k < 3; ++k) c->weight[k] = weight[k];
  c->mass = contact_effective_mass(w, c->body, c->vertex, c->weight);
  c->gap = fx_saturate((int64_t)to_q28(fx_root_length(root) - reach) + vec_dot_unit(rest, normal));
}

/* ---- one step ---- */

static void solve_constraint(fray_world *w, contact_constraint *c, const elastic_step *step) {
  if (c->kind == CONSTRAINT_VERTEX) turn_vertex(w, c);
  if (FRAY_MESHES && c->kind == CONSTRAINT_TRIANGLE) turn_triangle(w, c);
  const vec3 velocity =
      vec_sub_saturated(point_velocity(w, c, step), step_body_velocity(w, c->body));
  const int32_t least = step_speed_min(c->gap, w->membrane.constants->steps, step->rise);
  const vec3 wanted =
      step_contact_change(velocity, c->normal, least, w->rigid.bodies[c->body].friction);
  int32_t along = vec_dot_unit(velocity, c->normal);
  if (vec_span(wanted) != 0) {
    const vec3 u = vec_sub_saturated(velocity, half_of(w, c, step));
    const vec3 change = step_passive_change(w, c->mass, u, wanted);
    along = fx_add_saturated(along, vec_dot_unit(change, c->normal));
    push_point(w, c, change);
  }
  if (c->kind != CONSTRAINT_FLAT) return;
  const int64_t way = fx_mul_wide(along, step->part) + c->low;
  c->low = (int32_t)(way & INT32_MAX);
  c->gap = fx_saturate(c->gap + fx_asr64(way, ELASTIC_LOW_BITS));
}

void contact_constraints_solve(fray_world *w, const elastic_step *step) {
  contact_constraint *c = w->membrane.constraints;
  FRAY_ASSERT(w->membrane.constraint_count <= CONSTRAINTS_PER_CONTACT * w->capacity[POOL_CONTACTS]);
  for (uint32_t n = 0; n < w->membrane.constraint_count; ++n) solve_constraint(w, &c[n], step);
  contact_planes_solve(w, step);
  w->work.contact_constraints += w->membrane.constraint_count;
}
