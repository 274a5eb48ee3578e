/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/geometry/closest_point.h"

vec3 closest_narrow(vec3 v, unsigned bits) {
  FRAY_ASSERT(bits > 0 && bits < 32);
  return closest_shifted(v, closest_excess(closest_span(v), bits));
}

/* The perpendicular from the origin to the line p + w e: e x (p x e) = p |e|^2 - e (e . p). */
static vec3 perpendicular(vec3 p, vec3 e) {
  return vec_cross(e, closest_narrow(vec_cross(p, e), CLOSEST_BITS));
}

static void set_weight(closest_point *n, uint32_t k, int64_t part, int64_t whole) {
  n->part[k] = part;
  n->whole[k] = whole;
}

/* The interior is closest: the normal, from the origin to the plane; 0 where the plane contains the origin.
 */
static void set_interior(closest_point *n, const closest_face *f) {
  const vec3 normal = vec_cross(f->a, f->b);
  const int64_t side = vec_dot64(f->corner, normal);
  n->away = side < 0 ? vec_negated(normal) : normal;
  if (side == 0) n->away = vec_make(0, 0, 0);
}

/* The closest point of the edge p + w e, w in [0, 1]; part / whole is w of the closest point of its line.
 */
static void set_edge(closest_point *n, uint32_t k, vec3 p, vec3 e, int32_t part, int32_t whole) {
  if (part <= 0 || part >= whole) {
    n->away = part <= 0 ? p : vec_add(p, e);
    set_weight(n, k, part > 0, 1);
  } else {
    n->away = perpendicular(p, e);
    set_weight(n, k, part, whole);
  }
}

static closest_point closest_of_parallelogram(const closest_face *f) {
  closest_point n;
  const int32_t aa = vec_dot(f->a, f->a);
  const int32_t ab = vec_dot(f->a, f->b);
  const int32_t bb = vec_dot(f->b, f->b);
  const int32_t ac = vec_dot(f->a, f->corner);
  const int32_t bc = vec_dot(f->b, f->corner);
  const int64_t area = fx_mul_wide(aa, bb) - fx_mul_wide(ab, ab); /* squared */
  const int64_t u = fx_mul_wide(ab, bc) - fx_mul_wide(bb, ac);
  const int64_t v = fx_mul_wide(ab, ac) - fx_mul_wide(aa, bc);
  int beyond; /* v below 0, within, above 1 */
  if (u > 0 && u < area) {
    beyond = v <= 0 ? -1 : v >= area;
    if (beyond == 0) {
      set_weight(&n, 0, u, area);
      set_weight(&n, 1, v, area);
      set_interior(&n, f);
      return n;
    }
  } else {
    const int full = u > 0 && area > 0;
    const int32_t part = -(full ? bc + ab : bc);
    beyond = part <= 0 ? -1 : part >= bb;
    if (beyond == 0) {
      set_weight(&n, 0, full, 1);
      set_edge(&n, 1, full ? vec_add(f->corner, f->a) : f->corner, f->b, part, bb);
      return n;
    }
  }
  set_weight(&n, 1, beyond > 0, 1);
  if (beyond > 0)
    set_edge(&n, 0, vec_add(f->corner, f->b), f->a, -(ac + ab), aa);
  else
    set_edge(&n, 0, f->corner, f->a, -ac, aa);
  return n;
}

/* The edge from corner + a to corner + b is closest; part / whole is the weight of the latter. */
static void set_far_edge(closest_point *n, const closest_face *f, int64_t part, int64_t whole) {
  const vec3 e = vec_sub(f->b, f->a);
  n->away = perpendicular(vec_add(f->corner, f->a), vec_asr(e, 1));
  set_weight(n, 0, whole - part, whole);
  set_weight(n, 1, part, whole);
}

static closest_point closest_of_triangle(const closest_face *f) {
  closest_point n;
  const int32_t ab = vec_dot(f->a, f->b);
  /* a . (-corner) and b . (-corner) for each of the three corners */
  const int32_t a0 = -vec_dot(f->a, f->corner);
  const int32_t b0 = -vec_dot(f->b, f->corner);
  const int32_t a1 = a0 - vec_dot(f->a, f->a);
  const int32_t b1 = b0 - ab;
  const int32_t a2 = a0 - ab;
  const int32_t b2 = b0 - vec_dot(f->b, f->b);
  const int64_t inside_a = fx_mul_wide(a0, b1) - fx_mul_wide(a1, b0); /* barycentric weights, scaled */
  const int64_t inside_b = fx_mul_wide(a2, b0) - fx_mul_wide(a0, b2);
  const int64_t inside_far = fx_mul_wide(a1, b2) - fx_mul_wide(a2, b1);
  const int64_t to_b = (int64_t)b1 - a1;
  const int64_t to_a = (int64_t)a2 - b2;
  set_weight(&n, 0, 0, 1);
  set_weight(&n, 1, 0, 1);
  if (a0 <= 0 && b0 <= 0) {
    n.away = f->corner;
  } else if (a1 >= 0 && to_b <= 0) {
    set_weight(&n, 0, 1, 1);
    n.away = vec_add(f->corner, f->a);
  } else if (inside_a <= 0 && a0 >= 0 && a1 <= 0 && a0 > a1) {
    set_edge(&n, 0, f->corner, f->a, a0, a0 - a1);
  } else if (b2 >= 0 && to_a <= 0) {
    set_weight(&n, 1, 1, 1);
    n.away = vec_add(f->corner, f->b);
  } else if (inside_b <= 0 && b0 >= 0 && b2 <= 0 && b0 > b2) {
    set_edge(&n, 1, f->corner, f->b, b0, b0 - b2);
  } else if (inside_far <= 0 && to_b >= 0 && to_a >= 0 && to_a + to_b > 0) {
    set_far_edge(&n, f, to_b, to_a + to_b);
  } else {
    const int64_t all = inside_a + inside_b + inside_far;
    set_weight(&n, 0, inside_b, all);
    set_weight(&n, 1, inside_a, all);
    set_interior(&n, f);
  }
  return n;
}

closest_point closest_point_find(const closest_face *f, closest_shape shape) {
  FRAY_ASSERT(((closest_span(f->corner) | closest_span(f->a) | closest_span(f->b)) >> CLOSEST_BITS) <= 1);
  return shape == CLOSEST_TRIANGLE ? closest_of_triangle(f) : closest_of_parallelogram(f);
}
