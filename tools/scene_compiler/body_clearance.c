/* SPDX-License-Identifier: Apache-2.0 */
/* Refuses free bodies that begin inside of a plane or another body: a plane would put them out of it in the first
 * substep, at any speed that this takes. Spheres, capsules and boxes are boxes of their half sizes with a radius around
 * them; a mesh counts by its points, and two meshes are not tested. */
#include "rt/contact/shape.h"
#include "tools/scene_compiler/draft.h"

/* How deep a body is in another one, and the way out of it, Q30. */
typedef struct {
  int64_t depth;
  vec3 out;
} overlap;

static int is_round_box(const rigid_body *k) {
  return k->shape == FRAY_SPHERE || k->shape == FRAY_CAPSULE || k->shape == FRAY_BOX;
}

static vec3 start_of(const rigid_body *k) { return vec_of(k->start); }

/* The point of the box of half sizes that is nearest. */
static vec3 nearest_inside(const rigid_body *k, vec3 at) {
  const vec3 d = vec_sub(at, start_of(k));
  vec3 point = start_of(k);
  for (uint32_t n = 0; n < 3; ++n) {
    const int32_t along = fx_clamp(vec_dot_unit(d, shape_axis(k, n)), -k->half[n], k->half[n]);
    point = vec_add(point, vec_scale_unit(shape_axis(k, n), along));
  }
  return point;
}

/* Along an axis of either box, where the boxes meet. */
static overlap least_overlap(const rigid_body *k, const rigid_body *other) {
  const vec3 d = vec_sub(start_of(k), start_of(other));
  overlap least = {INT64_MAX, {0, 0, 0}};
  for (uint32_t n = 0; n < 6; ++n) {
    const vec3 axis = n < 3 ? shape_axis(k, n) : shape_axis(other, n - 3);
    const int32_t apart = vec_dot_unit(d, axis);
    const int64_t depth = shape_extent(k, axis) + shape_extent(other, axis) - fx_magnitude(apart);
    if (depth >= least.depth) continue;
    least.depth = depth;
    least.out = apart < 0 ? vec_negated(axis) : axis;
  }
  return least;
}

/* From point to nearest point and back: no nearer than they are, so what is apart is never taken as inside. */
static overlap round_boxes_overlap(const rigid_body *k, const rigid_body *other) {
  enum { ROUNDS = 200 };
  overlap o = {0, {0, 0, 0}};
  vec3 here = start_of(k);
  vec3 there = start_of(other);
  for (uint32_t round = 0; round < ROUNDS; ++round) {
    there = nearest_inside(other, here);
    here = nearest_inside(k, there);
  }
  const vec3 d = vec_sub(here, there);
  const uint64_t squared = vec_squared(d);
  if (squared == 0 || vec_is_within(d, 16)) return least_overlap(k, other); /* but for rounding, they meet */
  const vec_direction way = vec_direction_of(d);
  o.depth = (int64_t)k->radius + other->radius - way.length;
  o.out = way.unit;
  return o;
}

/* The deepest point of a mesh in a primitive. */
static overlap points_overlap(const fray_world *w, uint32_t mesh, const rigid_body *other) {
  const rigid_mesh_parts m = rigid_mesh_at(w, rigid_mesh_of_body(w, mesh));
  const vec3 d = vec_sub(start_of(&w->rigid.bodies[mesh]), start_of(other));
  overlap deepest = {0, {0, 0, 0}};
  for (uint32_t n = 0; n < (uint32_t)m.of->points; ++n) {
    vec3 normal = {0, 0, 0};
    const int32_t depth = shape_depth(other, vec_add(d, vec_of(m.points[n].at)), 0, &normal);
    if (depth <= deepest.depth) continue;
    deepest.depth = depth;
    deepest.out = normal;
  }
  return deepest;
}

static overlap overlap_of(const fray_world *w, uint32_t b, uint32_t other) {
  const rigid_body *k = &w->rigid.bodies[b];
  const rigid_body *o = &w->rigid.bodies[other];
  overlap none = {0, {0, 0, 0}};
  if (body_is_mesh(k)) return body_is_mesh(o) ? none : points_overlap(w, b, o);
  if (shape_is_plane(o)) {
    none.out = shape_plane_normal(o);
    none.depth = shape_extent(k, none.out) - vec_dot_unit(vec_sub(start_of(k), start_of(o)), none.out);
    return none;
  }
  if (body_is_mesh(o)) {
    overlap in = points_overlap(w, other, k);
    in.out = vec_negated(in.out);
    return in;
  }
  return is_round_box(k) && is_round_box(o) ? round_boxes_overlap(k, o) : none;
}

static int refuse_overlap(const draft *d, const fray_world *w, uint32_t b, uint32_t other, overlap o) {
  const exact lu = exact_mul(d->lu_per_cm, exact_make(FX_LU, 1));
  const vec3 start = start_of(&w->rigid.bodies[b]);
  const vec3 out = vec_scale_unit(o.out, (int32_t)o.depth);
  const int64_t at[3] = {(int64_t)start.x + out.x, (int64_t)start.y + out.y, (int64_t)start.z + out.z};
  char deep[SOURCE_VALUE];
  char where[3][SOURCE_VALUE];
  for (uint32_t n = 0; n < 3; ++n)
    draft_value(d, BLOCK_BODY + b, "at", UNIT_LENGTH, exact_div(exact_make(at[n], 1), lu), 0, where[n]);
  return draft_expected(d, BLOCK_BODY + b, "at",
                        "a place outside of '%s': at tick 0 it is %s inside of it; beside it is %s, %s, %s",
                        d->scene->bodies[other].name,
                        draft_value(d, BLOCK_BODY + b, "at", UNIT_LENGTH, exact_div(exact_make(o.depth, 1), lu), 0,
                                    deep),
                        where[0], where[1], where[2]);
}

int draft_body_clearance(const draft *d, const fray_world *w) {
  for (uint32_t b = 0; b < d->scene->body_count; ++b) {
    if (w->rigid.bodies[b].motion != FRAY_FREE) continue;
    for (uint32_t other = 0; other < d->scene->body_count; ++other) {
      if (other == b || (other > b && w->rigid.bodies[other].motion == FRAY_FREE)) continue;
      const overlap o = overlap_of(w, b, other);
      if (o.depth > w->params->thickness) return refuse_overlap(d, w, b, other, o);
    }
  }
  return 1;
}
