/* SPDX-License-Identifier: Apache-2.0 */
/* Couples that slip, LANES at a time: stage/slip.c says what is computed, in the same order. Of sums and
 * products of 64 bits only the bits that stand in the result are formed; what has more of them is left
 * to the scalar code, by slides_far. */
#ifndef FRAY_WIDE_SLIDES_H
#define FRAY_WIDE_SLIDES_H

#include "rt/wide/longs.h"
#include "rt/wide/slide.h"

#ifdef LANES_LONGS
enum { SLIDES_FAR = 1 << 26 }; /* of a way, a gap or a correction */

/* Ends of the closest pair: of the warp's spring, of the weft's. */
static const int slides_ends[4] = {SLIDE_WARP, SLIDE_FAR + 2, SLIDE_WEFT, SLIDE_FAR};

/* Of some couples. */
typedef struct {
  uint32_t alone; /* lanes that repeat no other */
  uint32_t id[SLIDE_ENDS][LANES];
  lanes at[SLIDE_ENDS][3];
  lanes way[4][3], squared[4], towards[4]; /* coarse */
  lanes part[4], down[4];                  /* squared in 16 bits: shifted by `down` */
  lanes apart[3];
  lanes facts;
  lanes least, on_warp, on_weft; /* of the closest pair */
  lane_mask second[2];           /* it is on the second spring of the weft, of the warp */
  lanes b[4];
  lanes far;                     /* the largest of what SLIDES_FAR bounds */
} slides;

LANES_INLINE lane_mask slides_has(lanes facts, uint32_t bit) {
  return lanes_below_zero(lanes_shl(facts, (unsigned)__builtin_clz(bit)));
}
LANES_INLINE lanes slides_farther(lanes far, lanes v) {
  return lanes_max(far, lanes_max(v, lanes_sub(lanes_all(-1), v)));
}
/* n / d for `count` of them, so that none waits for another; d is above 0, n below d * 2^bits and 2^31. */
LANES_INLINE void slides_divide(lanes *n, const lanes *d, unsigned bits, int count, lanes *quotient) {
  lanes missing[4]; /* the quotient's zeros */
  for (int k = 0; k < count; ++k) missing[k] = lanes_all(0);
  LONGS_UNROLLED
  for (unsigned left = bits; left != 0; --left) {
    const unsigned bit = left - 1u;
    LONGS_UNROLLED
    for (int k = 0; k < count; ++k) {
      const lanes rest = lanes_sub(n[k], bit == 0 ? d[k] : lanes_shl(d[k], bit));
      n[k] = lanes_lesser(n[k], rest);
      missing[k] = lanes_sub(lanes_add(missing[k], missing[k]), lanes_sign(rest));
    }
  }
  for (int k = 0; k < count; ++k)
    quotient[k] = lanes_sub(lanes_all((int32_t)((1u << bits) - 1u)), missing[k]);
}

/* n / d in Q15, both above 0, n at most 2 d, for four n. */
LANES_INLINE void slides_ratios(lanes n[4], lanes d, lanes quotient[4]) {
  lanes missing[4];
  for (int k = 0; k < 4; ++k) missing[k] = lanes_all(0);
  LONGS_UNROLLED
  for (unsigned left = 17; left != 0; --left) {
    const unsigned bit = left - 1u;
    const lanes part = bit > 15 ? lanes_add(d, d) : d;
    LONGS_UNROLLED
    for (int k = 0; k < 4; ++k) {
      const lanes rest = lanes_sub(n[k], part);
      n[k] = lanes_lesser(n[k], rest);
      missing[k] = lanes_sub(lanes_add(missing[k], missing[k]), lanes_sign(rest));
      if (bit < 16 && bit > 0) n[k] = lanes_add(n[k], n[k]);
    }
  }
  for (int k = 0; k < 4; ++k) quotient[k] = lanes_sub(lanes_all((1 << 17) - 1), missing[k]);
}

/* v, above 0, shifted down to 16 bits; by how much is added to `down`. */
LANES_INLINE lanes slides_down(lanes v, lanes *down) {
  LONGS_UNROLLED
  for (unsigned s = 8; s != 0; s /= 2u) {
    const lane_mask more = lanes_above(v, lanes_all((int32_t)(1u << (15u + s)) - 1));
    v = lanes_pick(more, lanes_asr(v, s), v);
    *down = lanes_add(*down, lanes_keep(more, lanes_all((int32_t)s)));
  }
  return v;
}

/* A quotient as a share: 0 where the numerator is below 0, 1 where it is at least the denominator. */
LANES_INLINE lanes slides_share(lanes quotient, lane_mask none, lane_mask not_all) {
  const lanes one = lanes_all(SLIDE_ONE);
  return lanes_pick(none, lanes_all(0), lanes_pick(not_all, lanes_min(quotient, one), one));
}

/* Pair k is of the warp's spring 2 + k / 2 and the weft's spring k % 2, by way. */
enum { SLIDES_PAIRS = 4 };
#define SLIDES_EACH LONGS_UNROLLED for (int k = 0; k < SLIDES_PAIRS; ++k)

/* Along the warps' springs to the closest points of the other lines; 0 where they are parallel. */
LANES_INLINE void slides_cross(const slides *s, const lanes ab[SLIDES_PAIRS], lanes on_warp[SLIDES_PAIRS]) {
  lanes n[SLIDES_PAIRS], d[SLIDES_PAIRS], quotient[SLIDES_PAIRS];
  lane_mask none[SLIDES_PAIRS], not_all[SLIDES_PAIRS], crosses[SLIDES_PAIRS];
  SLIDES_EACH {
    const lanes aa = s->squared[2 + k / 2];
    const lanes bb = s->squared[k % 2];
    const longs num =
        longs_sub(longs_mul(ab[k], s->towards[k % 2]), longs_mul(s->towards[2 + k / 2], bb));
    const longs den = longs_sub(longs_mul(aa, bb), longs_mul(ab[k], ab[k]));
    const longs whole = longs_shr(num, 15);
    const lane_mask wide = lanes_above(longs_low(longs_shr(den, 46)), lanes_all(0));
    const lanes v = lanes_pick(wide, longs_low(longs_shr(den, 31)), longs_low(longs_shr(den, 15)));
    lanes down = lanes_keep(wide, lanes_all(16));
    d[k] = slides_down(v, &down);
    n[k] = longs_low(longs_shr_by(longs_shl(whole, 15), down));
    none[k] = longs_negative(num);
    not_all[k] = longs_negative(longs_sub(whole, longs_shr(den, 15)));
    crosses[k] = longs_negative(longs_sub(longs_all(1 << 16), den));
  }
  slides_divide(n, d, 16, SLIDES_PAIRS, quotient);
  SLIDES_EACH on_warp[k] = lanes_keep(crosses[k], slides_share(quotient[k], none[k], not_all[k]));
}

/* From there to the closest points on the wefts' springs. */
LANES_INLINE void slides_to_weft(const slides *s, const lanes ab[SLIDES_PAIRS],
                                 const lanes on_warp[SLIDES_PAIRS], lanes on_weft[SLIDES_PAIRS]) {
  lanes n[SLIDES_PAIRS], d[SLIDES_PAIRS], quotient[SLIDES_PAIRS];
  lane_mask none[SLIDES_PAIRS], not_all[SLIDES_PAIRS];
  SLIDES_EACH {
    const int weft = k % 2;
    const longs num =
        longs_add(longs_mul(ab[k], on_warp[k]), longs_mul(s->towards[weft], lanes_all(SLIDE_ONE)));
    n[k] = longs_low(longs_shr_by(num, s->down[weft]));
    d[k] = s->part[weft];
    none[k] = longs_negative(num);
    not_all[k] = lanes_above(s->squared[weft], longs_low(longs_shr(num, 15)));
  }
  slides_divide(n, d, 16, SLIDES_PAIRS, quotient);
  SLIDES_EACH on_weft[k] = lanes_keep(lanes_above(s->squared[k % 2], lanes_all(0)),
                                      slides_share(quotient[k], none[k], not_all[k]));
}

/* Back again, where that is an end of the weft's spring. */
LANES_INLINE void slides_to_warp(const slides *s, const lanes ab[SLIDES_PAIRS],
                                 const lanes on_weft[SLIDES_PAIRS], lanes on_warp[SLIDES_PAIRS]) {
  lanes n[SLIDES_PAIRS], d[SLIDES_PAIRS], rest[SLIDES_PAIRS], quotient[SLIDES_PAIRS];
  lane_mask at_one[SLIDES_PAIRS];
  SLIDES_EACH {
    const int warp = 2 + k / 2;
    at_one[k] = lanes_above(on_weft[k], lanes_all(SLIDE_ONE - 1));
    rest[k] = lanes_sub(lanes_keep(at_one[k], ab[k]), s->towards[warp]);
    n[k] = lanes_shl_by(rest[k], lanes_sub(lanes_all(15), s->down[warp]));
    d[k] = s->part[warp];
  }
  slides_divide(n, d, 16, SLIDES_PAIRS, quotient);
  SLIDES_EACH {
    const lanes aa = s->squared[2 + k / 2];
    const lane_mask between = lanes_without(lanes_above(on_weft[k], lanes_all(0)), at_one[k]);
    const lanes share = slides_share(quotient[k], lanes_below_zero(rest[k]), lanes_above(aa, rest[k]));
    on_warp[k] = lanes_pick(between, on_warp[k], lanes_keep(lanes_above(aa, lanes_all(0)), share));
  }
}

/* Keeps pair k where it is closer than those before it. */
LANES_INLINE void slides_compare(slides *s, int k, lanes on_warp, lanes on_weft) {
  const int warp = 2 + k / 2;
  const int weft = k % 2;
  const lanes most = lanes_all(INT32_MAX);
  lanes gap[3];
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    const lanes along =
        lanes_sub(lanes_mul(s->way[warp][n], on_warp), lanes_mul(s->way[weft][n], on_weft));
    gap[n] = lanes_clamp(lanes_add(s->apart[n], lanes_asr(along, 15)), SLIDE_MOST);
  }
  lanes squared = lanes_dot(gap, gap);
  squared = lanes_pick(slides_has(s->facts, (uint32_t)SLIDE_NONE << warp), most, squared);
  squared = lanes_pick(slides_has(s->facts, (uint32_t)SLIDE_NONE << weft), most, squared);
  const lane_mask closer = lanes_above(s->least, squared);
  const lane_mask of_weft = lanes_without(s->second[0], closer);
  const lane_mask of_warp = lanes_without(s->second[1], closer);
  s->least = lanes_min(s->least, squared);
  s->on_warp = lanes_pick(closer, on_warp, s->on_warp);
  s->on_weft = lanes_pick(closer, on_weft, s->on_weft);
  s->second[0] = weft == 1 ? lanes_either(of_weft, closer) : of_weft;
  s->second[1] = warp == 3 ? lanes_either(of_warp, closer) : of_warp;
}

LANES_INLINE void slides_fetch(const slide_view *v, uint32_t first, uint32_t count, slides *s) {
  s->alone = lanes_bits(lanes_first(count));
  for (int e = 0; e < SLIDE_ENDS; ++e) {
    for (uint32_t n = 0; n < LANES; ++n)
      s->id[e][n] = (uint32_t)v->end[e][first + (n < count ? n : 0)];
    LONGS_UNROLLED
    for (int n = 0; n < 3; ++n) s->at[e][n] = lanes_of(v->at[n], s->id[e]);
  }
  uint32_t facts[LANES];
  for (uint32_t n = 0; n < LANES; ++n) facts[n] = (uint32_t)v->facts[first + (n < count ? n : 0)];
  s->facts = lanes_load((const int32_t *)facts);
}

LANES_INLINE lanes slides_coarse(lanes from, lanes to) {
  return lanes_clamp(lanes_round(lanes_sub(to, from), SLIDE_SHIFT), SLIDE_MOST);
}

LANES_INLINE void slides_look_around(slides *s) {
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) s->apart[n] = slides_coarse(s->at[SLIDE_WEFT][n], s->at[SLIDE_WARP][n]);
  LONGS_UNROLLED
  for (int way = 0; way < 4; ++way) {
    const lanes *from = s->at[way < 2 ? SLIDE_WEFT : SLIDE_WARP];
    const lane_mask none = slides_has(s->facts, (uint32_t)SLIDE_NONE << way);
    LONGS_UNROLLED
    for (int n = 0; n < 3; ++n)
      s->way[way][n] = lanes_pick(none, lanes_all(0), slides_coarse(from[n], s->at[SLIDE_FAR + way][n]));
    s->squared[way] = lanes_dot(s->way[way], s->way[way]);
    s->towards[way] = lanes_dot(s->way[way], s->apart);
    s->down[way] = lanes_all(0);
    s->part[way] = slides_down(s->squared[way], &s->down[way]);
  }
}

/* The closest of the four pairs: its far ends take the place of the first ones. */
LANES_INLINE void slides_choose(slides *s) {
  s->least = lanes_all(INT32_MAX);
  s->on_warp = s->on_weft = lanes_all(0);
  s->second[0] = s->second[1] = lanes_above(lanes_all(0), lanes_all(0));
  lanes ab[SLIDES_PAIRS], on_warp[SLIDES_PAIRS], on_weft[SLIDES_PAIRS];
  SLIDES_EACH ab[k] = lanes_dot(s->way[2 + k / 2], s->way[k % 2]);
  slides_cross(s, ab, on_warp);
  slides_to_weft(s, ab, on_warp, on_weft);
  slides_to_warp(s, ab, on_weft, on_warp);
  SLIDES_EACH slides_compare(s, k, on_warp[k], on_weft[k]);
  const lanes one = lanes_all(SLIDE_ONE);
  s->b[0] = lanes_sub(one, s->on_warp);
  s->b[1] = s->on_warp;
  s->b[2] = lanes_sub(one, s->on_weft);
  s->b[3] = s->on_weft;
  LONGS_UNROLLED
  for (int yarn = 0; yarn < 2; ++yarn) {
    const int e = SLIDE_FAR + 2 * yarn;
    LONGS_UNROLLED
    for (int n = 0; n < 3; ++n) s->at[e][n] = lanes_pick(s->second[yarn], s->at[e + 1][n], s->at[e][n]);
    const lanes id = lanes_pick(s->second[yarn], lanes_load((const int32_t *)s->id[e + 1]),
                                lanes_load((const int32_t *)s->id[e]));
    lanes_store((int32_t *)s->id[e], id);
  }
}

/* From the weft's point to the warp's. */
LANES_INLINE void slides_gap(slides *s, lanes gap[3]) {
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    const lanes warp = lanes_sub(s->at[SLIDE_FAR + 2][n], s->at[SLIDE_WARP][n]);
    const lanes weft = lanes_sub(s->at[SLIDE_FAR][n], s->at[SLIDE_WEFT][n]);
    gap[n] = lanes_sub(lanes_add(s->at[SLIDE_WARP][n], longs_round(longs_mul(warp, s->b[1]), 15)),
                       lanes_add(s->at[SLIDE_WEFT][n], longs_round(longs_mul(weft, s->b[3]), 15)));
    s->far = slides_farther(s->far, gap[n]);
  }
}

LANES_INLINE void slides_half_way(const slides *s, int back, lanes half[3]) {
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) half[n] = lanes_asr(lanes_sub(s->way[back + 1][n], s->way[back][n]), 1);
}

/* Towards the side on which the warp is. */
LANES_INLINE void slides_side(const slides *s, const lanes a[3], const lanes b[3], lanes side[3]) {
  const lane_mask under = slides_has(s->facts, SLIDE_UNDER);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    const int m = (n + 1) % 3;
    const int o = (n + 2) % 3;
    const lanes cross = lanes_sub(lanes_mul(a[m], b[o]), lanes_mul(a[o], b[m]));
    side[n] = lanes_pick(under, lanes_sub(lanes_all(0), cross), cross);
  }
}

/* Which of those behind their partner lie clearly there. */
LANES_INLINE lane_mask slides_clear(const slides *s, const lanes a[3], const lanes b[3], const lanes side[3]) {
  const lane_mask aslant =
      longs_negative(longs_sub(longs_mul(lanes_asr(lanes_dot(a, a), 2), lanes_asr(lanes_dot(b, b), 2)),
                               longs_shr(longs_squared(side), 2)));
  const lanes none = lanes_asr(lanes_shl(s->facts, 24), 28); /* all four bits are 0: 0 */
  return lanes_without(aslant, lanes_differ(none, lanes_all(0)));
}

/* What friction takes back of `moved`, of which `pressed` presses. */
LANES_INLINE void slides_friction(const slide_view *v, slides *s, const lanes normal[3], lanes pressed,
                                  lanes back[3]) {
  lanes slip[3];
  longs dot = longs_all(0);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    longs sum = longs_all(0);
    LONGS_UNROLLED
    for (int e = 0; e < 4; ++e) {
      const uint32_t *id = s->id[slides_ends[e]];
      const lanes since = lanes_sub(s->at[slides_ends[e]][n], lanes_of(v->predicted[n], id));
      const lanes moved = lanes_add(lanes_round(lanes_of(v->speed[n], id), FX_SUB_BITS), since);
      s->far = slides_farther(s->far, moved);
      const longs part = longs_mul(moved, s->b[e]);
      sum = e < 2 ? longs_add(sum, part) : longs_sub(sum, part);
    }
    slip[n] = longs_round(sum, 15);
    dot = longs_add(dot, longs_mul(slip[n], normal[n]));
  }
  const lanes along = longs_round(dot, 30);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) slip[n] = lanes_sub(slip[n], lanes_scaled(normal[n], along));
  const lanes limit = lanes_add(lanes_all(v->grip),
                                longs_low(longs_shr(longs_mul(pressed, lanes_all(v->friction)), 16)));
  const longs squared = longs_squared(slip);
  const lane_mask longer = longs_negative(longs_sub(longs_mul(limit, limit), squared));
  lanes m;
  const lanes_root root = lanes_rsqrt(squared, &m);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n)
    back[n] = lanes_pick(longer, lanes_scaled(lanes_unit(root, slip[n]), limit), slip[n]);
}

/* The way by which the gap is to grow; `quiet`: no velocity may change. */
LANES_INLINE lane_mask slides_way(const slide_view *v, slides *s, lanes way[3]) {
  const lanes most = lanes_all(v->thickness / 4);
  const int64_t near = v->thickness / 16 + 1;
  const lanes nothing = lanes_all(0);
  lanes gap[3], warp[3], weft[3], side[3], normal[3], m;
  slides_gap(s, gap);
  slides_half_way(s, 2, warp);
  slides_half_way(s, 0, weft);
  slides_side(s, warp, weft, side);
  longs squared = longs_squared(gap);
  const lane_mask together = longs_negative(longs_sub(squared, longs_all(near * near)));
  const longs ahead = longs_add(longs_add(longs_mul(gap[0], side[0]), longs_mul(gap[1], side[1])),
                                longs_mul(gap[2], side[2]));
  lane_mask through = lanes_above(nothing, nothing);
  const lane_mask behind = longs_negative(ahead);
  if (lanes_bits(behind) != 0)
    through = lanes_both(behind, slides_clear(s, warp, weft, side));
  through = lanes_without(through, together);
  if (lanes_bits(together) != 0) {
    LONGS_UNROLLED
    for (int n = 0; n < 3; ++n) gap[n] = lanes_pick(together, side[n], gap[n]);
    squared = longs_squared(gap);
  }
  const lanes_root root = lanes_rsqrt(squared, &m);
  const lanes length = lanes_root_length(root, m);
  const lanes pulled = lanes_pick(through, lanes_sub(nothing, most),
                                  lanes_clamp(lanes_sub(lanes_all(v->thickness), length), v->thickness / 4));
  const lanes by = lanes_pick(together, most, pulled);
  const lane_mask quiet = lanes_either(together, through);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    normal[n] = lanes_unit(root, gap[n]);
    way[n] = lanes_scaled(normal[n], by);
  }
  if ((v->friction | v->grip) != 0) {
    lanes back[3];
    slides_friction(v, s, normal, lanes_size(by), back);
    LONGS_UNROLLED
    for (int n = 0; n < 3; ++n) way[n] = lanes_sub(way[n], lanes_pick(quiet, nothing, back[n]));
  }
  const lane_mask moves = lanes_both(lanes_above(lanes_all(INT32_MAX), s->least),
                                     lanes_either(lanes_differ(longs_high(squared), nothing),
                                                  lanes_differ(longs_low(squared), nothing)));
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    way[n] = lanes_keep(moves, way[n]);
    s->far = slides_farther(s->far, way[n]);
  }
  return quiet;
}

/* How the ends share in a way. */
typedef struct {
  lanes share[4];      /* Q15 */
  lane_mask heavy[4];  /* a whole crossing */
  lane_mask last[4];   /* it makes up for what rounding left */
  lanes b_last, unit;  /* of that end; what a step of half a crossing is as its velocity */
  uint32_t id[LANES];
} slides_weights;

LANES_INLINE void slides_weigh(slides *s, slides_weights *k) {
  const lanes one = lanes_all(1);
  lanes ease[4] = {lanes_all(2), one, lanes_all(2), one};
  LONGS_UNROLLED
  for (int yarn = 0; yarn < 2; ++yarn) {
    const uint32_t bit = (uint32_t)SLIDE_LIGHT << 2 * yarn;
    const lanes first = lanes_keep(slides_has(s->facts, bit), one);
    const lanes second = lanes_keep(slides_has(s->facts, bit << 1), one);
    const int e = yarn == 0 ? 3 : 1;
    ease[e] = lanes_add(one, lanes_pick(s->second[yarn], second, first));
  }
  lanes sum = lanes_all(0);
  lanes most = lanes_mul(ease[0], s->b[0]);
  lanes last = lanes_all(0);
  lanes ids = lanes_load((const int32_t *)s->id[slides_ends[0]]);
  k->b_last = s->b[0];
  k->unit = lanes_all(1 << FX_SUB_BITS);
  LONGS_UNROLLED
  for (int n = 0; n < 4; ++n) {
    const lanes share = lanes_mul(ease[n], s->b[n]);
    const lane_mask more = lanes_above(share, most);
    sum = lanes_add(sum, lanes_mul(ease[n], lanes_asr(lanes_mul(s->b[n], lanes_asr(s->b[n], 1)), 14)));
    most = lanes_max(most, share);
    last = lanes_pick(more, lanes_all(n), last);
    k->b_last = lanes_pick(more, s->b[n], k->b_last);
    k->unit = lanes_pick(more, lanes_shl(ease[n], FX_SUB_BITS - 1), k->unit);
    ids = lanes_pick(more, lanes_load((const int32_t *)s->id[slides_ends[n]]), ids);
  }
  lanes_store((int32_t *)k->id, ids);
  const lane_mask all = lanes_above(one, lanes_all(0));
  lanes part[4];
  LONGS_UNROLLED
  for (int n = 0; n < 4; ++n) part[n] = lanes_mul(ease[n], s->b[n]);
  slides_ratios(part, sum, k->share);
  LONGS_UNROLLED
  for (int n = 0; n < 4; ++n) {
    k->heavy[n] = lanes_above(lanes_all(2), ease[n]);
    k->last[n] = lanes_without(all, lanes_differ(last, lanes_all(n)));
  }
}

/* How far the ends move along an axis; `rest` is what the last one adds. */
typedef struct {
  lanes moved[4], missing, rest;
} slides_step;

/* Predicted positions go along. */
LANES_INLINE void slides_follow(const slide_view *v, const slides *s, int axis, int end, lanes out,
                                uint32_t quiet) {
  int32_t words[LANES];
  lanes_store(words, out);
  for (; quiet != 0; quiet &= quiet - 1u) {
    const uint32_t n = (uint32_t)__builtin_ctz(quiet);
    int32_t *predicted = &v->predicted[axis][s->id[end][n]];
    *predicted = fx_wrap_add(*predicted, words[n]);
  }
}

LANES_INLINE void slides_put(const slide_view *v, const slides *s, const slides_weights *k, int axis,
                             const slides_step *t, lane_mask quiet) {
  lanes apart = lanes_all(0);
  LONGS_UNROLLED
  for (int n = 0; n < 4; ++n) {
    const int e = slides_ends[n];
    const lanes by = lanes_add(t->moved[n], lanes_keep(k->last[n], t->rest));
    const lanes momentum = lanes_add(by, lanes_keep(k->heavy[n], by));
    const lanes out = n < 2 ? by : lanes_sub(lanes_all(0), by);
    apart = n < 2 ? lanes_add(apart, momentum) : lanes_sub(apart, momentum);
    pairs_scatter(v->at[axis], s->id[e], lanes_add(s->at[e][axis], out));
    if (lanes_bits(quiet) != 0) slides_follow(v, s, axis, e, out, lanes_bits(quiet) & s->alone);
  }
  const lanes speed = lanes_of(v->speed[axis], k->id);
  const lanes change = lanes_mul(apart, k->unit);
  pairs_scatter(v->speed[axis], k->id, lanes_pick(quiet, speed, lanes_sub(speed, change)));
}

LANES_INLINE void slides_move(const slide_view *v, const slides *s, const slides_weights *k,
                              const lanes way[3], lane_mask quiet) {
  slides_step t[3];
  lanes n[3], d[3], quotient[3];
  lane_mask more = lanes_above(lanes_all(0), lanes_all(0));
  LONGS_UNROLLED
  for (int axis = 0; axis < 3; ++axis) {
    lanes missing = lanes_shl(way[axis], 15);
    LONGS_UNROLLED
    for (int e = 0; e < 4; ++e) {
      t[axis].moved[e] = longs_round(longs_mul(way[axis], k->share[e]), 15);
      missing = lanes_sub(missing, lanes_mul(t[axis].moved[e], s->b[e]));
    }
    t[axis].missing = missing;
    d[axis] = k->b_last;
    n[axis] = lanes_add(lanes_size(missing), lanes_asr(k->b_last, 1));
    more = lanes_either(more, lanes_above(n[axis], lanes_shl(d[axis], 5)));
  }
  if (lanes_bits(more) != 0)
    slides_divide(n, d, 16, 3, quotient);
  else
    slides_divide(n, d, 6, 3, quotient);
  LONGS_UNROLLED
  for (int axis = 0; axis < 3; ++axis) {
    t[axis].rest = lanes_signed(quotient[axis], t[axis].missing);
    slides_put(v, s, k, axis, &t[axis], quiet);
  }
}

/* Couples from `first` on, as far as none of LANES is left to the scalar code; returns how many. */
LANES_INLINE uint32_t slides_run(const slide_view *v, uint32_t first, uint32_t end) {
  for (uint32_t at = first; at < end; at += LANES) {
    slides s;
    slides_weights k;
    lanes way[3];
    s.far = lanes_all(0);
    slides_fetch(v, at, end - at < (uint32_t)LANES ? end - at : (uint32_t)LANES, &s);
    slides_look_around(&s);
    slides_choose(&s);
    const lane_mask quiet = slides_way(v, &s, way);
    if (lanes_bits(lanes_above(s.far, lanes_all(SLIDES_FAR))) != 0) return at - first;
    slides_weigh(&s, &k);
    slides_move(v, &s, &k, way, quiet);
  }
  return end - first;
}
#endif

#endif
