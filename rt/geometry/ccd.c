/* SPDX-License-Identifier: Apache-2.0 */
/* The Minkowski difference of the two is a flat face (closest_point.h) that moves; they are in contact
 * where it comes within the thickness of the origin. Time is skipped only for an exact reason:
 *
 * 1. Along an axis all corners of the face are farther than the thickness on one side, at t = 0 and at t =
 * 1, and so, as their paths are straight, at all times between.
 * 2. The plane of the face is too far from the origin: the cubic f(t) = corner . (a x b), in Bernstein
 * form, is above a margin on a whole interval because its four coefficients are. The face is rounded to 14
 * bits, each component by at most 1/2; a point of it is corner + u a + v b, off by at most 3/2 a component,
 * below 2.6 in length. So where the true face comes within h of the origin, |f| <= (h + 2.6) |a x b|, and
 * |a x b| is at most the longest of the three Bernstein coefficients of a x b. Halving intervals gives the
 * earliest time that is not excluded.
 * 3. At that time, the direction from the origin to the closest point of the face separates the two. Any
 * vector is a valid direction, so its errors do not matter: along it each corner moves on a straight line,
 * exact in Q24, and is apart until a time that a division gives, rounded down.
 *
 * Where step 3 advances by less than SHORTEST, the time is that of a contact. When HALVINGS or LOOKS are
 * used up, the time reached counts as a contact: work is bounded, and no contact is missed.
 *
 * So rounding to 14 bits misses no contact, but causes false alarms: pairs apart by less than about 2^-13
 * of their extent need a direction finer than 14 bits. For edges of 1/12 lu that is 1e-5 lu, 1/2000 of a
 * thickness of 1/50 lu. */
#include "rt/geometry/ccd.h"

#include "rt/geometry/closest_point.h"

enum {
  DEPTH = 12, /* halvings of the step */
  SHORTEST = CCD_ONE >> DEPTH,
  HALVINGS = 32,
  LOOKS = 5, /* separating directions tried */
  CUBIC_BITS = 29,
  CUBIC_ROUNDING = 2 + 2 * DEPTH, /* error of the first shift, and of 3 halvings a level */
  AWAY_BITS = 16,
  NEVER = CCD_ONE + 1 /* no contact until after the end */
};

typedef struct {
  closest_face begin, end;               /* Q24 */
  closest_face coarse_begin, coarse_end; /* in units of 2^shift */
  int32_t thickness;                     /* Q24 */
  unsigned shift;
  closest_shape shape;
} moving_face;

/* The cubic on an interval in Bernstein form, its coefficients scaled by 3 and to 32 bits. */
typedef struct {
  int32_t c[4];
  int32_t first, width; /* Q15 */
} interval;

typedef struct {
  closest_point nearest;
  int32_t apart_until; /* the two are apart until then, Q15 */
} separation;

static uint32_t face_span(const closest_face *f) {
  return closest_span(f->corner) | closest_span(f->a) | closest_span(f->b);
}
static closest_face face_rounded(const closest_face *f, unsigned s) {
  const closest_face coarse = {closest_shifted(f->corner, s), closest_shifted(f->a, s),
                               closest_shifted(f->b, s)};
  return coarse;
}

/* An upper bound of |v|: convex in v, and at least |v| at (1, 0, 0), (1, 1, 0) and (1, 1, 1). */
static uint32_t length_bound(vec3 v) {
  const uint32_t x = fx_magnitude(v.x);
  const uint32_t y = fx_magnitude(v.y);
  const uint32_t z = fx_magnitude(v.z);
  const uint32_t longest = x > y ? (x > z ? x : z) : (y > z ? y : z);
  return (longest + 1u) / 2u + (x + y + z + 1u) / 2u;
}

/* 1: the cubic is above the margin on the whole interval; -1: below its negative; 0: undecided. */
static int cubic_side(const int32_t c[4], int32_t margin) {
  if (c[0] > margin) return c[1] > margin && c[2] > margin && c[3] > margin;
  if (c[0] < -margin) return -(c[1] < -margin && c[2] < -margin && c[3] < -margin);
  return 0;
}

/* v * 2^up, below 2^63, in CUBIC_BITS bits and a sign; rounded down. */
FX_WRAPS static inline int32_t cubic_word(int64_t v, unsigned up) {
  return (int32_t)fx_asr64((int64_t)((uint64_t)v << up), 63 - CUBIC_BITS);
}

/* Fills the first interval and returns the margin, or -1 where the cubic is never within it. */
static int32_t make_cubic(const moving_face *m, interval *p) {
  const closest_face *f0 = &m->coarse_begin;
  const closest_face *f1 = &m->coarse_end;
  const vec3 n0 = vec_cross(f0->a, f0->b);
  const vec3 n2 = vec_cross(f1->a, f1->b);
  const vec3 n1 = vec_add(vec_cross(f0->a, f1->b), vec_cross(f1->a, f0->b)); /* twice */
  const int64_t c[4] = {
      3 * vec_dot64(f0->corner, n0), fx_add64(vec_dot64(f1->corner, n0), vec_dot64(f0->corner, n1)),
      fx_add64(vec_dot64(f0->corner, n2), vec_dot64(f1->corner, n1)), 3 * vec_dot64(f1->corner, n2)};
  const vec3 half = vec_asr(n1, 1);
  uint32_t longest = length_bound(n0);
  if (length_bound(n2) > longest) longest = length_bound(n2);
  if (length_bound(half) + 2u > longest) longest = length_bound(half) + 2u;
  /* thickness rounded up and 2.6, or both exact; times 3 as the coefficients */
  const uint32_t near = ((uint32_t)m->thickness >> m->shift) + (m->shift > 0 ? 4u : 0);
  const int64_t margin = (int64_t)fx_mul_wide_u(longest, 3u * near);
  uint64_t span = (uint64_t)margin;
  int above = 1;
  int below = 1;
  for (uint32_t n = 0; n < 4; ++n) {
    above = above && c[n] > margin;
    below = below && c[n] < -margin;
    span |= (uint64_t)(c[n] ^ fx_asr64(c[n], 63));
  }
  if (above || below) return -1;
  /* shifted to the top of 64 bits, and the upper word to CUBIC_BITS */
  const unsigned up = span == 0 ? 0 : fx_leading_zeros64(span) - 1u;
  for (uint32_t n = 0; n < 4; ++n) p->c[n] = cubic_word(c[n], up);
  p->first = 0;
  p->width = CCD_ONE;
  return cubic_word(margin, up) + CUBIC_ROUNDING;
}

/* Splits an interval in halves by de Casteljau's algorithm: *p becomes the left one, *right the right one.
 */
static void split_interval(interval *p, interval *right) {
  FRAY_ASSERT(p->width >= 2 && p->first >= 0 && p->first + p->width <= CCD_ONE);
  const int32_t ab = fx_asr(p->c[0] + p->c[1], 1);
  const int32_t bc = fx_asr(p->c[1] + p->c[2], 1);
  const int32_t cd = fx_asr(p->c[2] + p->c[3], 1);
  const int32_t abc = fx_asr(ab + bc, 1);
  const int32_t bcd = fx_asr(bc + cd, 1);
  right->c[3] = p->c[3];
  right->c[2] = cd;
  right->c[1] = bcd;
  right->c[0] = fx_asr(abc + bcd, 1);
  p->c[3] = right->c[0];
  p->c[2] = abc;
  p->c[1] = ab;
  p->width /= 2;
  right->width = p->width;
  right->first = p->first + p->width;
}

static vec3 lerp_scaled(vec3 begin, vec3 end, int32_t t) {
  return vec_add(vec_mul(begin, CCD_ONE - t), vec_mul(end, t));
}
static closest_face face_at(const moving_face *m, int32_t t) {
  FRAY_ASSERT(t >= 0 && t <= CCD_ONE);
  const closest_face fine = {lerp_scaled(m->coarse_begin.corner, m->coarse_end.corner, t),
                             lerp_scaled(m->coarse_begin.a, m->coarse_end.a, t),
                             lerp_scaled(m->coarse_begin.b, m->coarse_end.b, t)};
  return face_rounded(&fine, closest_excess(face_span(&fine), CLOSEST_BITS));
}

/* |away| in Q10, rounded up: the root is short by less than 2^-18 of itself and 1. Components to 2^16. */
static uint32_t length_q10(vec3 away) {
  const uint32_t root = fx_root_length(fx_rsqrt(vec_squared(away) << 20, FX_ROOT_COARSE));
  return root + (root >> 18) + 2u;
}

/* thickness * |away|, rounded up. */
static int64_t thickness_along(vec3 away, int32_t thickness) {
  FRAY_ASSERT(thickness >= 0);
  if (thickness == 0 || vec_squared(away) == 0) return 0;
  return (int64_t)(fx_mul_wide_u((uint32_t)thickness, length_q10(away)) >> 10) + 1;
}

/* closest_ratio(), rounded up. */
static int32_t ratio_above(int64_t part, int64_t whole) {
  FRAY_ASSERT(part >= 0 && part <= whole && whole > 0);
  const unsigned lz = fx_leading_zeros64((uint64_t)whole);
  const unsigned s = lz < 48u ? 48u - lz : 0;
  if (s == 0) return (int32_t)(((uint32_t)part << 15) / (uint32_t)whole) + 1;
  return (int32_t)((((uint32_t)(part >> s) + 1u) << 15) / (uint32_t)(whole >> s)) + 1;
}

/* One corner, `begin` and `end` beyond the thickness along a direction. Returns the time from
 * `now` until which it stays apart (`now` where it is not), at most `apart_until`. */
static inline int32_t corner_apart_until(int64_t begin, int64_t end, int32_t now, int32_t apart_until) {
  FRAY_ASSERT(now >= 0 && now <= apart_until);
  if (begin > 0) {
    if (end > 0) return apart_until;
    return fx_min(apart_until, fx_max(now, closest_ratio(begin, begin - end)));
  }
  if (end <= 0 || now < ratio_above(-begin, end - begin)) return now;
  return apart_until;
}

/* Until when, from `now` on, the face is farther than the thickness from the origin along `away`. */
static int32_t apart_until_along(const moving_face *m, vec3 away, int32_t now) {
  const int64_t reach = thickness_along(away, m->thickness);
  int64_t begin = vec_dot64(m->begin.corner, away) - reach;
  int64_t end = vec_dot64(m->end.corner, away) - reach;
  const int64_t a_begin = vec_dot64(m->begin.a, away);
  const int64_t a_end = vec_dot64(m->end.a, away);
  const int64_t b_begin = vec_dot64(m->begin.b, away);
  const int64_t b_end = vec_dot64(m->end.b, away);
  int32_t apart_until = corner_apart_until(begin, end, now, NEVER);
  apart_until = corner_apart_until(begin + a_begin, end + a_end, now, apart_until);
  apart_until = corner_apart_until(begin + b_begin, end + b_end, now, apart_until);
  if (m->shape == CLOSEST_PARALLELOGRAM)
    apart_until = corner_apart_until(begin + a_begin + b_begin, end + a_end + b_end, now, apart_until);
  return apart_until;
}

/* Separates the face from the origin at `now`, until found->apart_until: `now` where that fails. */
__attribute__((noinline)) static void separate_at(const moving_face *m, int32_t now, separation *found) {
  const closest_face f = face_at(m, now);
  found->nearest = closest_point_find(&f, m->shape);
  found->nearest.away = closest_narrow(found->nearest.away, AWAY_BITS);
  found->apart_until = apart_until_along(m, found->nearest.away, now);
}

/* The normal of a contact at distance 0: that of the face on the side of t = 0, or where the face contained
 * the origin then (parallel edges), the difference of the two points at t = 0. */
static vec3 normal_at_start(const moving_face *m, const ccd_contact *c) {
  const closest_face f = face_at(m, c->time);
  const closest_face *g = &m->coarse_begin;
  const vec3 on_a = vec_asr(vec_mul(g->a, c->weight[0]), 15);
  const vec3 on_b = vec_asr(vec_mul(g->b, c->weight[1]), 15);
  const vec3 was = vec_add(vec_add(g->corner, on_a), on_b);
  const vec3 normal = closest_narrow(vec_cross(f.a, f.b), AWAY_BITS);
  const int64_t side = vec_dot64(was, normal);
  if (side == 0) return was;
  return side > 0 ? normal : vec_negated(normal);
}

static void fill_contact(const moving_face *m, const closest_point *nearest, ccd_contact *c) {
  for (uint32_t n = 0; n < 2; ++n)
    c->weight[n] = closest_weight(nearest, n);
  vec3 away = nearest->away;
  if (vec_squared(away) == 0) away = normal_at_start(m, c);
  c->normal = vec_unit(away, vec_make(0, 1 << 30, 0));
}

typedef struct {
  int32_t margin;
  uint32_t count, halvings;    /* of pending intervals; halvings left */
  interval pending[DEPTH + 1]; /* the earliest last */
} search;

/* The earliest time from `apart_until` on that the cubic does not exclude; NEVER where there is none. When
 * the halvings are used up, the begin of the current interval. */
__attribute__((noinline)) static int32_t next_candidate(search *s, int32_t apart_until) {
  const int32_t margin = s->margin;
  uint32_t count = s->count;
  uint32_t halvings = s->halvings;
  while (count > 0) {
    interval p = s->pending[--count];
    while (p.first + p.width >= apart_until && cubic_side(p.c, margin) == 0) {
      const int outside = p.c[0] > margin || p.c[0] < -margin;
      if (p.width == SHORTEST || halvings == 0 || (p.first >= apart_until && !outside)) {
        s->pending[count] = p;
        s->count = count + 1u;
        s->halvings = halvings;
        return fx_max(apart_until, p.first);
      }
      split_interval(&p, &s->pending[count++]);
      --halvings;
    }
  }
  return NEVER;
}

static int first_contact(const moving_face *m, ccd_contact *contact) {
  search s;
  separation found;
  s.margin = make_cubic(m, &s.pending[0]);
  if (s.margin < 0) return 0;
  s.count = 1;
  s.halvings = HALVINGS;
  found.apart_until = 0;
  uint32_t looks = LOOKS;
  while (found.apart_until != NEVER) {
    const int32_t now = next_candidate(&s, found.apart_until);
    if (now == NEVER) return 0;
    separate_at(m, now, &found);
    --looks;
    if (found.apart_until != NEVER && (found.apart_until <= now + SHORTEST || looks == 0)) {
      contact->time = now;
      fill_contact(m, &found.nearest, contact);
      return 1;
    }
  }
  return 0;
}

/* Of a face whose two positions are set. */
static int find_contact(moving_face *m, int32_t thickness, closest_shape shape, ccd_contact *contact) {
  const uint32_t span = face_span(&m->begin) | face_span(&m->end) | (uint32_t)thickness;
  m->shift = closest_excess(span, CLOSEST_BITS);
  m->coarse_begin = face_rounded(&m->begin, m->shift);
  m->coarse_end = face_rounded(&m->end, m->shift);
  m->thickness = thickness;
  m->shape = shape;
  return first_contact(m, contact);
}

/* The Minkowski difference of two edges, and of a triangle and a point. */
static closest_face edges_face(vec3 a0, vec3 a1, vec3 b0, vec3 b1) {
  const closest_face f = {vec_sub(b0, a0), vec_sub(a0, a1), vec_sub(b1, b0)};
  return f;
}
static closest_face triangle_face(vec3 point, vec3 a, vec3 b, vec3 c) {
  const closest_face f = {vec_sub(a, point), vec_sub(b, a), vec_sub(c, a)};
  return f;
}
#define EDGES_FACE(when) edges_face(first[0].when, first[1].when, second[0].when, second[1].when)
#define TRIANGLE_FACE(when) \
  triangle_face(point->when, triangle[0].when, triangle[1].when, triangle[2].when)

typedef struct {
  int32_t low, high;
} range;

static inline range range_of(int32_t a, int32_t b) {
  const range r = {fx_min(a, b), fx_max(a, b)};
  return r;
}
static inline range range_extended(range r, int32_t c) {
  r.low = fx_min(r.low, c);
  r.high = fx_max(r.high, c);
  return r;
}
/* Whether two ranges stay on the same sides of each other, farther apart than the thickness. */
static inline int stay_apart(range first_begin, range second_begin, range first_end, range second_end,
                             int32_t thickness) {
  return (second_begin.low - first_begin.high > thickness && second_end.low - first_end.high > thickness) ||
         (first_begin.low - second_begin.high > thickness && first_end.low - second_end.high > thickness);
}

/* Whether the ends of two edges are apart along an axis. */
#define EDGES_APART(axis) \
  stay_apart(range_of(first[0].begin.axis, first[1].begin.axis), \
             range_of(second[0].begin.axis, second[1].begin.axis), \
             range_of(first[0].end.axis, first[1].end.axis), \
             range_of(second[0].end.axis, second[1].end.axis), thickness)

int ccd_edges(const ccd_path first[2], const ccd_path second[2], int32_t thickness, ccd_contact *contact) {
  FRAY_ASSERT(thickness >= 0 && thickness <= FX_WORLD_MAX);
  if (EDGES_APART(x) || EDGES_APART(y) || EDGES_APART(z)) return 0;
  moving_face m;
  m.begin = EDGES_FACE(begin);
  m.end = EDGES_FACE(end);
  return find_contact(&m, thickness, CLOSEST_PARALLELOGRAM, contact);
}

/* The same of a point and a triangle. */
#define TRIANGLE_APART(axis) \
  stay_apart( \
      range_of(point->begin.axis, point->begin.axis), \
      range_extended(range_of(triangle[0].begin.axis, triangle[1].begin.axis), triangle[2].begin.axis), \
      range_of(point->end.axis, point->end.axis), \
      range_extended(range_of(triangle[0].end.axis, triangle[1].end.axis), triangle[2].end.axis), \
      thickness)

int ccd_point_triangle(const ccd_path *point, const ccd_path triangle[3], int32_t thickness,
                       ccd_contact *contact) {
  FRAY_ASSERT(thickness >= 0 && thickness <= FX_WORLD_MAX);
  if (TRIANGLE_APART(x) || TRIANGLE_APART(y) || TRIANGLE_APART(z)) return 0;
  moving_face m;
  m.begin = TRIANGLE_FACE(begin);
  m.end = TRIANGLE_FACE(end);
  return find_contact(&m, thickness, CLOSEST_TRIANGLE, contact);
}

/* The least distance of a corner along a direction. */
static int64_t min_along(const closest_face *f, closest_shape shape, vec3 away) {
  const int64_t corner = vec_dot64(f->corner, away);
  const int64_t a = vec_dot64(f->a, away);
  const int64_t b = vec_dot64(f->b, away);
  const int64_t side = a < b ? a : b;
  const int64_t least = side < 0 ? side : 0;
  return fx_add64(corner, shape == CLOSEST_PARALLELOGRAM && a + b < least ? a + b : least);
}

/* least / length, length in Q10. */
static int32_t gap_of(int64_t least, uint32_t length) {
  FRAY_ASSERT(length > 0);
  if (least <= 0) return 0;
  const uint32_t gap = fx_divide_wide((uint64_t)least << 10, length);
  return gap > INT32_MAX ? INT32_MAX : (int32_t)gap;
}

static ccd_gap gaps_of(closest_face begin, closest_face end, closest_shape shape) {
  ccd_gap gap = {0, 0};
  const closest_face coarse = face_rounded(&begin, closest_excess(face_span(&begin), CLOSEST_BITS));
  const vec3 away = closest_narrow(closest_point_find(&coarse, shape).away, AWAY_BITS);
  if (vec_squared(away) == 0) return gap;
  const uint32_t length = length_q10(away);
  gap.begin = gap_of(min_along(&begin, shape, away), length);
  gap.end = gap_of(min_along(&end, shape, away), length);
  return gap;
}

ccd_gap ccd_gap_edges(const ccd_path first[2], const ccd_path second[2]) {
  return gaps_of(EDGES_FACE(begin), EDGES_FACE(end), CLOSEST_PARALLELOGRAM);
}

ccd_gap ccd_gap_point_triangle(const ccd_path *point, const ccd_path triangle[3]) {
  return gaps_of(TRIANGLE_FACE(begin), TRIANGLE_FACE(end), CLOSEST_TRIANGLE);
}
