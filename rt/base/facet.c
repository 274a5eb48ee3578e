/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/base/facet.h"

vec3 facet_narrow(vec3 v, unsigned bits) {
  return facet_shifted(v, facet_excess(facet_span(v), bits));
}

/* From the origin straight to the line through p along e: e x (p x e) = p |e|^2 - e (e . p). */
static vec3 to_line(vec3 p, vec3 e) {
  return facet_cross(e, facet_narrow(facet_cross(p, e), FACET_BITS));
}

static void weigh(facet_nearest *n, uint32_t k, int64_t part, int64_t whole) {
  n->part[k] = part;
  n->whole[k] = whole;
}

/* The normal, towards the plane from the origin. */
static void take_inside(facet_nearest *n, const facet *f) {
  const vec3 normal = facet_cross(f->a, f->b);
  const int64_t side = facet_dot_wide(f->corner, normal);
  n->away = side < 0 ? vec_make(-normal.x, -normal.y, -normal.z) : normal;
  if (side == 0) n->away = vec_make(0, 0, 0);
}

/* The nearest point of p + w e, w in [0, 1], where part / whole is where the line has it. */
static void take_edge(facet_nearest *n, uint32_t k, vec3 p, vec3 e, int32_t part, int32_t whole) {
  if (part <= 0 || part >= whole) {
    n->away = part <= 0 ? p : vec_add(p, e);
    weigh(n, k, part > 0, 1);
  } else {
    n->away = to_line(p, e);
    weigh(n, k, part, whole);
  }
}

static facet_nearest look_parallelogram(const facet *f) {
  facet_nearest n;
  const int32_t aa = facet_dot(f->a, f->a);
  const int32_t ab = facet_dot(f->a, f->b);
  const int32_t bb = facet_dot(f->b, f->b);
  const int32_t ac = facet_dot(f->a, f->corner);
  const int32_t bc = facet_dot(f->b, f->corner);
  const int64_t area = fx_mul_wide(aa, bb) - fx_mul_wide(ab, ab); /* squared */
  const int64_t u = fx_mul_wide(ab, bc) - fx_mul_wide(bb, ac);
  const int64_t v = fx_mul_wide(ab, ac) - fx_mul_wide(aa, bc);
  int beyond; /* v below 0, within, above 1 */
  if (u > 0 && u < area) {
    beyond = v <= 0 ? -1 : v >= area;
    if (beyond == 0) {
      weigh(&n, 0, u, area);
      weigh(&n, 1, v, area);
      take_inside(&n, f);
      return n;
    }
  } else {
    const int full = u > 0 && area > 0;
    const int32_t part = -(full ? bc + ab : bc);
    beyond = part <= 0 ? -1 : part >= bb;
    if (beyond == 0) {
      weigh(&n, 0, full, 1);
      take_edge(&n, 1, full ? vec_add(f->corner, f->a) : f->corner, f->b, part, bb);
      return n;
    }
  }
  weigh(&n, 1, beyond > 0, 1);
  if (beyond > 0)
    take_edge(&n, 0, vec_add(f->corner, f->b), f->a, -(ac + ab), aa);
  else
    take_edge(&n, 0, f->corner, f->a, -ac, aa);
  return n;
}

/* The edge from the end of a to the end of b; part / whole is the weight of the latter. */
static void take_far_edge(facet_nearest *n, const facet *f, int64_t part, int64_t whole) {
  const vec3 e = vec_sub(f->b, f->a);
  const vec3 half = vec_make(fx_asr(e.x, 1), fx_asr(e.y, 1), fx_asr(e.z, 1));
  n->away = to_line(vec_add(f->corner, f->a), half);
  weigh(n, 0, whole - part, whole);
  weigh(n, 1, part, whole);
}

static facet_nearest look_triangle(const facet *f) {
  facet_nearest n;
  const int32_t ab = facet_dot(f->a, f->b);
  /* how far along a and b the origin is, seen from each corner */
  const int32_t a0 = -facet_dot(f->a, f->corner);
  const int32_t b0 = -facet_dot(f->b, f->corner);
  const int32_t a1 = a0 - facet_dot(f->a, f->a);
  const int32_t b1 = b0 - ab;
  const int32_t a2 = a0 - ab;
  const int32_t b2 = b0 - facet_dot(f->b, f->b);
  const int64_t inside_a = fx_mul_wide(a0, b1) - fx_mul_wide(a1, b0); /* weights of the corners */
  const int64_t inside_b = fx_mul_wide(a2, b0) - fx_mul_wide(a0, b2);
  const int64_t inside_far = fx_mul_wide(a1, b2) - fx_mul_wide(a2, b1);
  const int64_t to_b = (int64_t)b1 - a1;
  const int64_t to_a = (int64_t)a2 - b2;
  weigh(&n, 0, 0, 1);
  weigh(&n, 1, 0, 1);
  if (a0 <= 0 && b0 <= 0) {
    n.away = f->corner;
  } else if (a1 >= 0 && to_b <= 0) {
    weigh(&n, 0, 1, 1);
    n.away = vec_add(f->corner, f->a);
  } else if (inside_a <= 0 && a0 >= 0 && a1 <= 0 && a0 > a1) {
    take_edge(&n, 0, f->corner, f->a, a0, a0 - a1);
  } else if (b2 >= 0 && to_a <= 0) {
    weigh(&n, 1, 1, 1);
    n.away = vec_add(f->corner, f->b);
  } else if (inside_b <= 0 && b0 >= 0 && b2 <= 0 && b0 > b2) {
    take_edge(&n, 1, f->corner, f->b, b0, b0 - b2);
  } else if (inside_far <= 0 && to_b >= 0 && to_a >= 0 && to_a + to_b > 0) {
    take_far_edge(&n, f, to_b, to_a + to_b);
  } else {
    const int64_t all = inside_a + inside_b + inside_far;
    weigh(&n, 0, inside_b, all);
    weigh(&n, 1, inside_a, all);
    take_inside(&n, f);
  }
  return n;
}

facet_nearest facet_look(const facet *f, facet_shape shape) {
  return shape == FACET_TRIANGLE ? look_triangle(f) : look_parallelogram(f);
}
