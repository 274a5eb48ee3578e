/* SPDX-License-Identifier: Apache-2.0 */
/* The differences of the points of the two are a facet (facet.h) that moves; a contact is where it
 * comes within the thickness of the origin. Times are passed over only for a reason that is exact:
 *
 * 1. Along an axis all corners of the facet stay farther than the thickness on one side, at t = 0
 *    and at t = 1, and so, as their ways are straight, at all times between.
 * 2. The plane of the facet is too far from the origin: the cubic f(t) = corner . (a x b), in
 *    Bernstein form, is above a margin on all of an interval because its four coefficients are.
 *    The facet is rounded to 14 bits, each component by at most 1/2; a point of it is corner + u a
 *    + v b, off by at most 3/2 a component, below 2.6 in length. So where the true facet comes
 *    within h of the origin, |f| <= (h + 2.6) |a x b|, and |a x b| is at most the longest of the
 *    three Bernstein coefficients of a x b. Halving intervals gives the least time not excluded.
 * 3. There, the direction from the origin to the nearest point of the facet separates the two. It
 *    is any vector, so its errors do not matter: along it each corner moves on a straight line,
 *    exact in Q24, and is apart until a time that a division gives, rounded down.
 *
 * If 3. passes less than SHORTEST the time is that of a contact. When HALVINGS or LOOKS are used up
 * the rest counts as one: work is bounded, and no contact is missed.
 *
 * So the rounding to 14 bits costs no contact, but false alarms: two that stay apart by less than
 * about 2^-13 of their extent need a direction that 14 bits do not give. For edges of 1/12 lu that
 * is 1e-5 lu, 1/2000 of a thickness of 1/50 lu. */
#include "rt/base/sweep.h"

#include "rt/base/facet.h"

enum {
  DEPTH = 12, /* halvings of the step */
  SHORTEST = SWEEP_ONE >> DEPTH,
  HALVINGS = 32,
  LOOKS = 5, /* directions that are tried */
  CUBIC_BITS = 29,
  CUBIC_ROUNDING = 2 + 2 * DEPTH, /* by the first shift, and by 3 halves a level */
  AWAY_BITS = 16,
  NEVER = SWEEP_ONE + 1 /* no contact until after the end */
};

typedef struct {
  facet begin, end;               /* Q24 */
  facet coarse_begin, coarse_end; /* in units of 2^shift */
  int32_t thickness;              /* Q24 */
  unsigned shift;
  facet_shape shape;
} moving;

/* The cubic on an interval, its coefficients scaled by 3 and to 32 bits. */
typedef struct {
  int32_t c[4];
  int32_t first, width; /* Q15 */
} piece;

typedef struct {
  facet_nearest nearest;
  int32_t clear; /* apart until here, Q15 */
} look;

static uint32_t facet_extent(const facet *f) {
  return facet_span(f->corner) | facet_span(f->a) | facet_span(f->b);
}
static facet facet_coarse(const facet *f, unsigned s) {
  const facet coarse = {facet_shifted(f->corner, s), facet_shifted(f->a, s),
                        facet_shifted(f->b, s)};
  return coarse;
}
static void make_coarse(moving *m) {
  const uint32_t span = facet_extent(&m->begin) | facet_extent(&m->end) | (uint32_t)m->thickness;
  m->shift = facet_excess(span, FACET_BITS);
  m->coarse_begin = facet_coarse(&m->begin, m->shift);
  m->coarse_end = facet_coarse(&m->end, m->shift);
}

/* At least |v|: it is convex in v, and right for (1, 0, 0), (1, 1, 0) and (1, 1, 1). */
static uint32_t length_most(vec3 v) {
  const uint32_t x = fx_magnitude(v.x);
  const uint32_t y = fx_magnitude(v.y);
  const uint32_t z = fx_magnitude(v.z);
  const uint32_t longest = x > y ? (x > z ? x : z) : (y > z ? y : z);
  return (longest + 1u) / 2u + (x + y + z + 1u) / 2u;
}

/* 1, 0, -1: the cubic is above, perhaps within, below the margin on all of the piece. */
static int side_of(const int32_t c[4], int32_t margin) {
  if (c[0] > margin) return c[1] > margin && c[2] > margin && c[3] > margin;
  if (c[0] < -margin) return -(c[1] < -margin && c[2] < -margin && c[3] < -margin);
  return 0;
}

/* v * 2^up, below 2^63, in CUBIC_BITS bits and a sign; rounded down. */
FX_WRAPS static inline int32_t cubic_word(int64_t v, unsigned up) {
  return (int32_t)fx_asr64((int64_t)((uint64_t)v << up), 63 - CUBIC_BITS);
}

/* Fills the first piece and returns the margin, or -1 where the cubic is never within it. */
static int32_t make_cubic(const moving *m, piece *p) {
  const facet *f0 = &m->coarse_begin;
  const facet *f1 = &m->coarse_end;
  const vec3 n0 = facet_cross(f0->a, f0->b);
  const vec3 n2 = facet_cross(f1->a, f1->b);
  const vec3 n1 = vec_add(facet_cross(f0->a, f1->b), facet_cross(f1->a, f0->b)); /* twice */
  const int64_t c[4] = {3 * facet_dot_wide(f0->corner, n0),
                        fx_add64(facet_dot_wide(f1->corner, n0), facet_dot_wide(f0->corner, n1)),
                        fx_add64(facet_dot_wide(f0->corner, n2), facet_dot_wide(f1->corner, n1)),
                        3 * facet_dot_wide(f1->corner, n2)};
  const vec3 half = vec_make(fx_asr(n1.x, 1), fx_asr(n1.y, 1), fx_asr(n1.z, 1));
  uint32_t longest = length_most(n0);
  if (length_most(n2) > longest) longest = length_most(n2);
  if (length_most(half) + 2u > longest) longest = length_most(half) + 2u;
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
  /* to the top of 64 bits, the upper word of which is taken to CUBIC_BITS */
  const unsigned up = span == 0 ? 0 : fx_leading_zeros64(span) - 1u;
  for (uint32_t n = 0; n < 4; ++n) p->c[n] = cubic_word(c[n], up);
  p->first = 0;
  p->width = SWEEP_ONE;
  return cubic_word(margin, up) + CUBIC_ROUNDING;
}

/* Halves a piece by de Casteljau's scheme: the left half stays, the right one goes to `right`. */
static void halve(piece *p, piece *right) {
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

static vec3 between(vec3 begin, vec3 end, int32_t t) {
  return vec_make(begin.x * (SWEEP_ONE - t) + end.x * t, begin.y * (SWEEP_ONE - t) + end.y * t,
                  begin.z * (SWEEP_ONE - t) + end.z * t);
}
static facet facet_at(const moving *m, int32_t t) {
  const facet fine = {between(m->coarse_begin.corner, m->coarse_end.corner, t),
                      between(m->coarse_begin.a, m->coarse_end.a, t),
                      between(m->coarse_begin.b, m->coarse_end.b, t)};
  return facet_coarse(&fine, facet_excess(facet_extent(&fine), FACET_BITS));
}

/* thickness * |away|, rounded up; components of `away` to 2^16. */
static int64_t reach_along(vec3 away, int32_t thickness) {
  if (thickness == 0) return 0;
  /* 10 more bits of the root; it is short by less than 2^-18 of itself and 1 */
  const uint64_t squared = vec_squared(away);
  if (squared == 0) return 0;
  const uint32_t length = fx_root_length(fx_rsqrt(squared << 20, FX_ROOT_COARSE));
  return (int64_t)(fx_mul_wide_u((uint32_t)thickness, length + (length >> 18) + 2u) >> 10) + 1;
}

/* part / whole in Q15, for 0 <= part <= whole, whole > 0: not above it, */
static int32_t ratio_down(int64_t part, int64_t whole) {
  const unsigned lz = fx_leading_zeros64((uint64_t)whole);
  const unsigned s = lz < 48u ? 48u - lz : 0;
  if (s == 0) return (int32_t)(((uint32_t)part << 15) / (uint32_t)whole);
  return (int32_t)(((uint32_t)(part >> s) << 15) / ((uint32_t)(whole >> s) + 1u));
}
/* and above it. */
static int32_t ratio_above(int64_t part, int64_t whole) {
  const unsigned lz = fx_leading_zeros64((uint64_t)whole);
  const unsigned s = lz < 48u ? 48u - lz : 0;
  if (s == 0) return (int32_t)(((uint32_t)part << 15) / (uint32_t)whole) + 1;
  return (int32_t)((((uint32_t)(part >> s) + 1u) << 15) / (uint32_t)(whole >> s)) + 1;
}

/* One corner, `begin` and `end` beyond the thickness along a direction. Returns the time from
 * `now` until which it stays apart (which is `now` where it is not), at most `clear`. */
static inline int32_t corner_clear(int64_t begin, int64_t end, int32_t now, int32_t clear) {
  if (begin > 0) {
    if (end > 0) return clear;
    return fx_min(clear, fx_max(now, ratio_down(begin, begin - end)));
  }
  if (end <= 0 || now < ratio_above(-begin, end - begin)) return now;
  return clear;
}

/* How long the facet stays apart from the origin along `away`, from `now` on. */
static int32_t clear_along(const moving *m, vec3 away, int32_t now) {
  const int64_t reach = reach_along(away, m->thickness);
  int64_t begin = facet_dot_wide(m->begin.corner, away) - reach;
  int64_t end = facet_dot_wide(m->end.corner, away) - reach;
  const int64_t a_begin = facet_dot_wide(m->begin.a, away);
  const int64_t a_end = facet_dot_wide(m->end.a, away);
  const int64_t b_begin = facet_dot_wide(m->begin.b, away);
  const int64_t b_end = facet_dot_wide(m->end.b, away);
  int32_t clear = corner_clear(begin, end, now, NEVER);
  clear = corner_clear(begin + a_begin, end + a_end, now, clear);
  clear = corner_clear(begin + b_begin, end + b_end, now, clear);
  if (m->shape == FACET_PARALLELOGRAM)
    clear = corner_clear(begin + a_begin + b_begin, end + a_end + b_end, now, clear);
  return clear;
}

/* Looks at the facet now; it stays apart until seen->clear, which is `now` where it is not. */
__attribute__((noinline)) static void look_at(const moving *m, int32_t now, look *seen) {
  const facet f = facet_at(m, now);
  seen->nearest = facet_look(&f, m->shape);
  seen->nearest.away = facet_narrow(seen->nearest.away, AWAY_BITS);
  seen->clear = clear_along(m, seen->nearest.away, now);
}

static vec3 unit_of(vec3 v) {
  const uint64_t n = vec_squared(v);
  if (n == 0) return vec_make(0, 1 << 30, 0);
  const fx_root root = fx_rsqrt(n, FX_ROOT_FINE);
  return vec_make(fx_root_unit(root, v.x), fx_root_unit(root, v.y), fx_root_unit(root, v.z));
}

/* Which way the contact looks where the two touch: the normal of the facet, or for edges along each
 * other the way between them, as at the begin of the step. */
static vec3 away_before(const moving *m, const sweep_contact *c) {
  const facet f = facet_at(m, c->time);
  const facet *g = &m->coarse_begin;
  const vec3 was = vec_make(
      g->corner.x + fx_asr(fx_mul(g->a.x, c->at[0]), 15) + fx_asr(fx_mul(g->b.x, c->at[1]), 15),
      g->corner.y + fx_asr(fx_mul(g->a.y, c->at[0]), 15) + fx_asr(fx_mul(g->b.y, c->at[1]), 15),
      g->corner.z + fx_asr(fx_mul(g->a.z, c->at[0]), 15) + fx_asr(fx_mul(g->b.z, c->at[1]), 15));
  const vec3 normal = facet_narrow(facet_cross(f.a, f.b), AWAY_BITS);
  const int64_t side = facet_dot_wide(was, normal);
  if (side == 0) return was;
  return side > 0 ? normal : vec_make(-normal.x, -normal.y, -normal.z);
}

static void describe(const moving *m, const facet_nearest *nearest, sweep_contact *c) {
  for (uint32_t n = 0; n < 2; ++n)
    c->at[n] = nearest->whole[n] > 0 ? ratio_down(nearest->part[n], nearest->whole[n]) : 0;
  vec3 away = nearest->away;
  if (vec_squared(away) == 0) away = away_before(m, c);
  c->normal = unit_of(away);
}

typedef struct {
  int32_t margin;
  uint32_t count, halvings; /* pieces that wait, halvings left */
  piece waiting[DEPTH + 1]; /* the earliest last */
} search;

/* The least time from `clear` on that the cubic does not exclude; NEVER where there is none. When
 * the halvings are used up that is where the piece at hand begins. */
__attribute__((noinline)) static int32_t seek(search *s, int32_t clear) {
  const int32_t margin = s->margin;
  uint32_t count = s->count;
  uint32_t halvings = s->halvings;
  while (count > 0) {
    piece p = s->waiting[--count];
    while (p.first + p.width >= clear && side_of(p.c, margin) == 0) {
      const int outside = p.c[0] > margin || p.c[0] < -margin;
      if (p.width == SHORTEST || halvings == 0 || (p.first >= clear && !outside)) {
        s->waiting[count] = p;
        s->count = count + 1u;
        s->halvings = halvings;
        return fx_max(clear, p.first);
      }
      halve(&p, &s->waiting[count++]);
      --halvings;
    }
  }
  return NEVER;
}

static int first_contact(const moving *m, sweep_contact *contact) {
  search s;
  look seen;
  s.margin = make_cubic(m, &s.waiting[0]);
  if (s.margin < 0) return 0;
  s.count = 1;
  s.halvings = HALVINGS;
  seen.clear = 0;
  uint32_t looks = LOOKS;
  while (seen.clear != NEVER) {
    const int32_t now = seek(&s, seen.clear);
    if (now == NEVER) return 0;
    look_at(m, now, &seen);
    --looks;
    if (seen.clear != NEVER && (seen.clear <= now + SHORTEST || looks == 0)) {
      contact->time = now;
      describe(m, &seen.nearest, contact);
      return 1;
    }
  }
  return 0;
}

static int first_of(moving *m, sweep_contact *contact) {
  make_coarse(m);
  return first_contact(m, contact);
}

typedef struct {
  int32_t low, high;
} range;

static inline range range_two(int32_t a, int32_t b) {
  const range r = {fx_min(a, b), fx_max(a, b)};
  return r;
}
static inline range range_more(range r, int32_t c) {
  r.low = fx_min(r.low, c);
  r.high = fx_max(r.high, c);
  return r;
}
/* Whether the differences of two ranges stay on one side, farther than the thickness. */
static inline int stay_apart(range first_begin, range second_begin, range first_end,
                             range second_end, int32_t thickness) {
  return (second_begin.low - first_begin.high > thickness &&
          second_end.low - first_end.high > thickness) ||
         (first_begin.low - second_begin.high > thickness &&
          first_end.low - second_end.high > thickness);
}

/* Along one axis: the corners of two edges, */
#define EDGES_APART(axis) \
  stay_apart(range_two(first[0].begin.axis, first[1].begin.axis), \
             range_two(second[0].begin.axis, second[1].begin.axis), \
             range_two(first[0].end.axis, first[1].end.axis), \
             range_two(second[0].end.axis, second[1].end.axis), thickness)

int sweep_edges(const sweep_point first[2], const sweep_point second[2], int32_t thickness,
                sweep_contact *contact) {
  if (EDGES_APART(x) || EDGES_APART(y) || EDGES_APART(z)) return 0;
  moving m;
  m.begin.corner = vec_sub(second[0].begin, first[0].begin);
  m.begin.a = vec_sub(first[0].begin, first[1].begin);
  m.begin.b = vec_sub(second[1].begin, second[0].begin);
  m.end.corner = vec_sub(second[0].end, first[0].end);
  m.end.a = vec_sub(first[0].end, first[1].end);
  m.end.b = vec_sub(second[1].end, second[0].end);
  m.thickness = thickness;
  m.shape = FACET_PARALLELOGRAM;
  return first_of(&m, contact);
}

/* of a point and a triangle. */
#define TRIANGLE_APART(axis) \
  stay_apart( \
      range_two(point->begin.axis, point->begin.axis), \
      range_more(range_two(triangle[0].begin.axis, triangle[1].begin.axis), \
                 triangle[2].begin.axis), \
      range_two(point->end.axis, point->end.axis), \
      range_more(range_two(triangle[0].end.axis, triangle[1].end.axis), triangle[2].end.axis), \
      thickness)

int sweep_point_triangle(const sweep_point *point, const sweep_point triangle[3], int32_t thickness,
                         sweep_contact *contact) {
  if (TRIANGLE_APART(x) || TRIANGLE_APART(y) || TRIANGLE_APART(z)) return 0;
  moving m;
  m.begin.corner = vec_sub(triangle[0].begin, point->begin);
  m.begin.a = vec_sub(triangle[1].begin, triangle[0].begin);
  m.begin.b = vec_sub(triangle[2].begin, triangle[0].begin);
  m.end.corner = vec_sub(triangle[0].end, point->end);
  m.end.a = vec_sub(triangle[1].end, triangle[0].end);
  m.end.b = vec_sub(triangle[2].end, triangle[0].end);
  m.thickness = thickness;
  m.shape = FACET_TRIANGLE;
  return first_of(&m, contact);
}

/* By the corner that is least far along a direction. */
static int64_t least_along(const facet *f, facet_shape shape, vec3 away) {
  const int64_t corner = facet_dot_wide(f->corner, away);
  const int64_t a = facet_dot_wide(f->a, away);
  const int64_t b = facet_dot_wide(f->b, away);
  const int64_t side = a < b ? a : b;
  const int64_t least = side < 0 ? side : 0;
  return fx_add64(corner, shape == FACET_PARALLELOGRAM && a + b < least ? a + b : least);
}

/* least / |away|, whose length is 2^-10 of `length`. */
static int32_t gap_of(int64_t least, uint32_t length) {
  if (least <= 0) return 0;
  const uint32_t gap = fx_divide_wide((uint64_t)least << 10, length);
  return gap > INT32_MAX ? INT32_MAX : (int32_t)gap;
}

static sweep_gap gaps_of(const facet *begin, const facet *end, facet_shape shape) {
  sweep_gap gap = {0, 0};
  const facet coarse = facet_coarse(begin, facet_excess(facet_extent(begin), FACET_BITS));
  const vec3 away = facet_narrow(facet_look(&coarse, shape).away, AWAY_BITS);
  const uint64_t squared = vec_squared(away);
  if (squared == 0) return gap;
  /* as in reach_along() */
  const uint32_t root = fx_root_length(fx_rsqrt(squared << 20, FX_ROOT_COARSE));
  const uint32_t length = root + (root >> 18) + 2u;
  gap.begin = gap_of(least_along(begin, shape, away), length);
  gap.end = gap_of(least_along(end, shape, away), length);
  return gap;
}

sweep_gap sweep_gap_edges(const sweep_point first[2], const sweep_point second[2]) {
  const facet begin = {vec_sub(second[0].begin, first[0].begin), vec_sub(first[0].begin, first[1].begin),
                       vec_sub(second[1].begin, second[0].begin)};
  const facet end = {vec_sub(second[0].end, first[0].end), vec_sub(first[0].end, first[1].end),
                     vec_sub(second[1].end, second[0].end)};
  return gaps_of(&begin, &end, FACET_PARALLELOGRAM);
}

sweep_gap sweep_gap_point_triangle(const sweep_point *point, const sweep_point triangle[3]) {
  const facet begin = {vec_sub(triangle[0].begin, point->begin), vec_sub(triangle[1].begin, triangle[0].begin),
                       vec_sub(triangle[2].begin, triangle[0].begin)};
  const facet end = {vec_sub(triangle[0].end, point->end), vec_sub(triangle[1].end, triangle[0].end),
                     vec_sub(triangle[2].end, triangle[0].end)};
  return gaps_of(&begin, &end, FACET_TRIANGLE);
}
