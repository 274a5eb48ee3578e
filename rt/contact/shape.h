/* SPDX-License-Identifier: Apache-2.0 */
/* Geometry of the primitives: the one place of rt, beside the table SHAPES in state/rigid_body.h, that a
 * new shape changes. Plain switches, no pointers to functions: the bound of the stack follows from the
 * call graph. A capsule lies along its first axis; the normal of a plane is its second axis. */
#ifndef FRAY_CONTACT_SHAPE_H
#define FRAY_CONTACT_SHAPE_H

#include "rt/state/rigid_body.h"

static int64_t shape_extent(const rigid_body *s, vec3 along) __attribute__((unused));
static int32_t shape_depth(const rigid_body *s, vec3 d, int32_t skin, vec3 *normal) __attribute__((unused));

static inline vec3 shape_axis(const rigid_body *s, uint32_t n) {
  FRAY_ASSERT(n < 3);
  return vec_of(&s->axes[3 * n]);
}

/* A half space: everything on the far side of it is inside. */
static inline int shape_is_plane(const rigid_body *s) { return s->shape == FRAY_PLANE; }
static inline vec3 shape_plane_normal(const rigid_body *s) { return shape_axis(s, 1); }
static inline int shape_faces_up(const rigid_body *s) {
  return shape_is_plane(s) && s->axes[3] == 0 && s->axes[4] == 1 << 30 && s->axes[5] == 0;
}

/* The squared distance from its centre at which a particle is certainly apart; 0 where there is none. */
static inline uint64_t shape_apart_squared(const rigid_body *s, int32_t skin) {
  return s->shape == FRAY_SPHERE ? fx_square(s->radius + skin) : 0;
}

/* Depth of d below the surface of a sphere around the origin, and the normal if that is positive. */
__attribute__((always_inline)) static inline int32_t shape_round_depth(vec3 d, int32_t radius, vec3 *normal) {
  const uint64_t n = vec_squared(d);
  if (n >= fx_square(radius)) return 0;
  if (n == 0) {
    *normal = vec_make(0, 1 << 30, 0);
    return radius;
  }
  const fx_root root = fx_rsqrt(n, FX_ROOT_FINE);
  *normal = vec_root_unit(root, d);
  return fx_max(0, radius - (int32_t)fx_root_length(root));
}

static int32_t shape_box_depth(const rigid_body *s, vec3 d, int32_t skin, vec3 *normal) {
  int32_t depth_min = INT32_MAX;
  for (uint32_t n = 0; n < 3; ++n) {
    const vec3 axis = shape_axis(s, n);
    const int32_t along = vec_dot_unit(d, axis);
    const int64_t depth = (int64_t)s->half[n] + skin - fx_magnitude(along);
    if (depth <= 0) return 0;
    if (depth < depth_min) {
      depth_min = (int32_t)depth;
      *normal = along < 0 ? vec_negated(axis) : axis;
    }
  }
  return depth_min;
}

/* How deep a particle at d from the centre is below the surface, `skin` included; 0: outside. The
 * outward normal, Q30, if it is inside. */
static int32_t shape_depth(const rigid_body *s, vec3 d, int32_t skin, vec3 *normal) {
  FRAY_ASSERT(body_is_primitive(s) && skin >= 0);
  switch (s->shape) {
    case FRAY_SPHERE:
      return shape_round_depth(d, s->radius + skin, normal);
    case FRAY_CAPSULE: {
      const vec3 axis = shape_axis(s, 0);
      const int32_t along = fx_clamp(vec_dot_unit(d, axis), -s->half[0], s->half[0]);
      return shape_round_depth(vec_sub(d, vec_scale_unit(axis, along)), s->radius + skin, normal);
    }
    case FRAY_BOX:
      return shape_box_depth(s, d, skin, normal);
    case FRAY_PLANE:
      *normal = shape_plane_normal(s);
      return (int32_t)fx_clamp64((int64_t)skin - vec_dot_unit(d, *normal), 0, INT32_MAX);
    default:
      return 0;
  }
}

/* The same, out of line. */
int32_t shape_depth_at(const rigid_body *s, vec3 d, int32_t skin, vec3 *normal);

/* How far a primitive reaches from its centre along a unit vector. All are a sphere swept along a box. */
static int64_t shape_extent(const rigid_body *s, vec3 along) {
  int64_t extent = s->radius;
  for (uint32_t n = 0; n < 3; ++n)
    extent += fx_magnitude(vec_dot_unit(vec_scale_unit(shape_axis(s, n), s->half[n]), along));
  return extent;
}

#endif
