/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/woven/yarn_slip.c, same order of operations. Crossings that slip, LANES at a time. Only
 * those bits of a 64-bit sum or product are formed that reach the result; a group with larger values
 * (YARN_SLIP_LANES_FAR) is left to the scalar code. */
#ifndef FRAY_SIMD_YARN_SLIP_LANES_INL_H
#define FRAY_SIMD_YARN_SLIP_LANES_INL_H

#include "rt/simd/divide_lanes.inl.h"
#include "rt/simd/yarn_slip_view.h"

#ifdef LANES_HAVE_64
enum { YARN_SLIP_LANES_FAR = 1 << 26 }; /* of a motion, a gap or a correction */

/* Ends of the closest pair of springs: two of the warp, two of the weft. */
static const int yarn_slip_lanes_ends[4] = {SLIP_WARP, SLIP_FAR + 2, SLIP_WEFT, SLIP_FAR};

/* A group of crossings. */
typedef struct {
  uint32_t alone; /* bit n: lane n holds a crossing of its own, no copy */
  uint32_t id[SLIP_ENDS][LANES];
  lanes at[SLIP_ENDS][3];
  lanes way[4][3], squared[4], towards[4]; /* coarse */
  lanes part[4], down[4];                  /* squared 2^-down, in 16 bits */
  lanes apart[3];
  lanes facts;
  lanes least, on_warp, on_weft; /* of the closest pair */
  lane_mask second[2];           /* it is on the second spring of the weft, of the warp */
  lanes b[4];
  lanes far; /* the largest value that YARN_SLIP_LANES_FAR bounds */
} yarn_slip_lanes;

LANES_INLINE lane_mask yarn_slip_lanes_fact(lanes facts, uint32_t bit) {
  return lanes_negative(lanes_shl(facts, (unsigned)__builtin_clz(bit)));
}
LANES_INLINE lanes yarn_slip_lanes_farther(lanes far, lanes v) {
  return lanes_max(far, lanes_max(v, lanes_sub(lanes_set(-1), v)));
}
/* A quotient as a Q15 share: 0 where the numerator is below 0, 1 where it is at least the denominator. */
LANES_INLINE lanes yarn_slip_lanes_clamp_share(lanes quotient, lane_mask none, lane_mask not_all) {
  const lanes one = lanes_set(SLIP_VIEW_ONE);
  return lanes_select(none, lanes_set(0), lanes_select(not_all, lanes_min(quotient, one), one));
}

/* Pair k: spring 2 + k / 2 of the warp with spring k % 2 of the weft. */
enum { YARN_SLIP_LANES_PAIRS = 4 };
#define YARN_SLIP_LANES_EACH \
  LANES_UNROLL \
  for (int k = 0; k < YARN_SLIP_LANES_PAIRS; ++k)

/* Q15 along the warp's springs, the point closest to the line of the weft's; 0 where they are parallel. */
LANES_INLINE void yarn_slip_lanes_on_warp(const yarn_slip_lanes *s, const lanes ab[YARN_SLIP_LANES_PAIRS],
                                          lanes on_warp[YARN_SLIP_LANES_PAIRS]) {
  lanes n[YARN_SLIP_LANES_PAIRS], d[YARN_SLIP_LANES_PAIRS], quotient[YARN_SLIP_LANES_PAIRS];
  lane_mask none[YARN_SLIP_LANES_PAIRS], not_all[YARN_SLIP_LANES_PAIRS], crosses[YARN_SLIP_LANES_PAIRS];
  YARN_SLIP_LANES_EACH {
    const lanes aa = s->squared[2 + k / 2];
    const lanes bb = s->squared[k % 2];
    const lanes64 num =
        lanes64_sub(lanes64_mul(ab[k], s->towards[k % 2]), lanes64_mul(s->towards[2 + k / 2], bb));
    const lanes64 den = lanes64_sub(lanes64_mul(aa, bb), lanes64_mul(ab[k], ab[k]));
    const lanes64 whole = lanes64_shr(num, 15);
    const lane_mask wide = lanes_greater(lanes64_low(lanes64_shr(den, 46)), lanes_set(0));
    const lanes v =
        lanes_select(wide, lanes64_low(lanes64_shr(den, 31)), lanes64_low(lanes64_shr(den, 15)));
    lanes down = lanes_or_zero(wide, lanes_set(16));
    d[k] = lanes_to_16_bits(v, &down);
    n[k] = lanes64_low(lanes64_shr_by(lanes64_shl(whole, 15), down));
    none[k] = lanes64_negative(num);
    not_all[k] = lanes64_negative(lanes64_sub(whole, lanes64_shr(den, 15)));
    crosses[k] = lanes64_negative(lanes64_sub(lanes64_set(1 << 16), den));
  }
  lanes_divide_bits(n, d, 16, YARN_SLIP_LANES_PAIRS, quotient);
  YARN_SLIP_LANES_EACH on_warp[k] =
      lanes_or_zero(crosses[k], yarn_slip_lanes_clamp_share(quotient[k], none[k], not_all[k]));
}

/* Q15 along the weft's springs, the point closest to that. */
LANES_INLINE void yarn_slip_lanes_on_weft(const yarn_slip_lanes *s, const lanes ab[YARN_SLIP_LANES_PAIRS],
                                          const lanes on_warp[YARN_SLIP_LANES_PAIRS],
                                          lanes on_weft[YARN_SLIP_LANES_PAIRS]) {
  lanes n[YARN_SLIP_LANES_PAIRS], d[YARN_SLIP_LANES_PAIRS], quotient[YARN_SLIP_LANES_PAIRS];
  lane_mask none[YARN_SLIP_LANES_PAIRS], not_all[YARN_SLIP_LANES_PAIRS];
  YARN_SLIP_LANES_EACH {
    const int weft = k % 2;
    const lanes64 num = lanes64_add(lanes64_mul(ab[k], on_warp[k]),
                                    lanes64_mul(s->towards[weft], lanes_set(SLIP_VIEW_ONE)));
    n[k] = lanes64_low(lanes64_shr_by(num, s->down[weft]));
    d[k] = s->part[weft];
    none[k] = lanes64_negative(num);
    not_all[k] = lanes_greater(s->squared[weft], lanes64_low(lanes64_shr(num, 15)));
  }
  lanes_divide_bits(n, d, 16, YARN_SLIP_LANES_PAIRS, quotient);
  YARN_SLIP_LANES_EACH on_weft[k] =
      lanes_or_zero(lanes_greater(s->squared[k % 2], lanes_set(0)),
                    yarn_slip_lanes_clamp_share(quotient[k], none[k], not_all[k]));
}

/* Back on the warp's spring, where that point is an end of the weft's. */
LANES_INLINE void yarn_slip_lanes_back_on_warp(const yarn_slip_lanes *s,
                                               const lanes ab[YARN_SLIP_LANES_PAIRS],
                                               const lanes on_weft[YARN_SLIP_LANES_PAIRS],
                                               lanes on_warp[YARN_SLIP_LANES_PAIRS]) {
  lanes n[YARN_SLIP_LANES_PAIRS], d[YARN_SLIP_LANES_PAIRS], rest[YARN_SLIP_LANES_PAIRS],
      quotient[YARN_SLIP_LANES_PAIRS];
  lane_mask at_one[YARN_SLIP_LANES_PAIRS];
  YARN_SLIP_LANES_EACH {
    const int warp = 2 + k / 2;
    at_one[k] = lanes_greater(on_weft[k], lanes_set(SLIP_VIEW_ONE - 1));
    rest[k] = lanes_sub(lanes_or_zero(at_one[k], ab[k]), s->towards[warp]);
    n[k] = lanes_shl_by(rest[k], lanes_sub(lanes_set(15), s->down[warp]));
    d[k] = s->part[warp];
  }
  lanes_divide_bits(n, d, 16, YARN_SLIP_LANES_PAIRS, quotient);
  YARN_SLIP_LANES_EACH {
    const lanes aa = s->squared[2 + k / 2];
    const lane_mask between = mask_and_not(lanes_greater(on_weft[k], lanes_set(0)), at_one[k]);
    const lanes share =
        yarn_slip_lanes_clamp_share(quotient[k], lanes_negative(rest[k]), lanes_greater(aa, rest[k]));
    on_warp[k] = lanes_select(between, on_warp[k], lanes_or_zero(lanes_greater(aa, lanes_set(0)), share));
  }
}

/* Keeps pair k where it is closer than those before it. */
LANES_INLINE void yarn_slip_lanes_keep_closer(yarn_slip_lanes *s, int k, lanes on_warp, lanes on_weft) {
  const int warp = 2 + k / 2;
  const int weft = k % 2;
  const lanes most = lanes_set(INT32_MAX);
  lanes gap[3];
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    const lanes along = lanes_sub(lanes_mul(s->way[warp][n], on_warp), lanes_mul(s->way[weft][n], on_weft));
    gap[n] = lanes_clamp(lanes_add(s->apart[n], lanes_asr(along, 15)), SLIP_MOST);
  }
  lanes squared = lanes_dot(gap, gap);
  squared = lanes_select(yarn_slip_lanes_fact(s->facts, (uint32_t)SLIP_END_MISSING << warp), most, squared);
  squared = lanes_select(yarn_slip_lanes_fact(s->facts, (uint32_t)SLIP_END_MISSING << weft), most, squared);
  const lane_mask closer = lanes_greater(s->least, squared);
  const lane_mask of_weft = mask_and_not(s->second[0], closer);
  const lane_mask of_warp = mask_and_not(s->second[1], closer);
  s->least = lanes_min(s->least, squared);
  s->on_warp = lanes_select(closer, on_warp, s->on_warp);
  s->on_weft = lanes_select(closer, on_weft, s->on_weft);
  s->second[0] = weft == 1 ? mask_or(of_weft, closer) : of_weft;
  s->second[1] = warp == 3 ? mask_or(of_warp, closer) : of_warp;
}

LANES_INLINE void yarn_slip_lanes_load(const yarn_slip_view *v, uint32_t first, uint32_t count,
                                       yarn_slip_lanes *s) {
  s->alone = mask_bits(mask_first(count));
  for (int e = 0; e < SLIP_ENDS; ++e) {
    for (uint32_t n = 0; n < LANES; ++n) s->id[e][n] = (uint32_t)v->end[e][first + (n < count ? n : 0)];
    LANES_UNROLL
    for (int n = 0; n < 3; ++n) s->at[e][n] = lanes_gather(v->at[n], s->id[e]);
  }
  uint32_t facts[LANES];
  for (uint32_t n = 0; n < LANES; ++n) facts[n] = (uint32_t)v->facts[first + (n < count ? n : 0)];
  s->facts = lanes_load((const int32_t *)facts);
}

LANES_INLINE lanes yarn_slip_lanes_coarse(lanes from, lanes to) {
  return lanes_clamp(lanes_round(lanes_sub(to, from), SLIP_SHIFT), SLIP_MOST);
}

LANES_INLINE void yarn_slip_lanes_directions(yarn_slip_lanes *s) {
  LANES_UNROLL
  for (int n = 0; n < 3; ++n)
    s->apart[n] = yarn_slip_lanes_coarse(s->at[SLIP_WEFT][n], s->at[SLIP_WARP][n]);
  LANES_UNROLL
  for (int way = 0; way < 4; ++way) {
    const lanes *from = s->at[way < 2 ? SLIP_WEFT : SLIP_WARP];
    const lane_mask none = yarn_slip_lanes_fact(s->facts, (uint32_t)SLIP_END_MISSING << way);
    LANES_UNROLL
    for (int n = 0; n < 3; ++n)
      s->way[way][n] =
          lanes_select(none, lanes_set(0), yarn_slip_lanes_coarse(from[n], s->at[SLIP_FAR + way][n]));
    s->squared[way] = lanes_dot(s->way[way], s->way[way]);
    s->towards[way] = lanes_dot(s->way[way], s->apart);
    s->down[way] = lanes_set(0);
    s->part[way] = lanes_to_16_bits(s->squared[way], &s->down[way]);
  }
}

/* Finds the closest of the four pairs and puts its far ends in the first place. */
LANES_INLINE void yarn_slip_lanes_closest(yarn_slip_lanes *s) {
  s->least = lanes_set(INT32_MAX);
  s->on_warp = s->on_weft = lanes_set(0);
  s->second[0] = s->second[1] = lanes_greater(lanes_set(0), lanes_set(0));
  lanes ab[YARN_SLIP_LANES_PAIRS], on_warp[YARN_SLIP_LANES_PAIRS], on_weft[YARN_SLIP_LANES_PAIRS];
  YARN_SLIP_LANES_EACH ab[k] = lanes_dot(s->way[2 + k / 2], s->way[k % 2]);
  yarn_slip_lanes_on_warp(s, ab, on_warp);
  yarn_slip_lanes_on_weft(s, ab, on_warp, on_weft);
  yarn_slip_lanes_back_on_warp(s, ab, on_weft, on_warp);
  YARN_SLIP_LANES_EACH yarn_slip_lanes_keep_closer(s, k, on_warp[k], on_weft[k]);
  const lanes one = lanes_set(SLIP_VIEW_ONE);
  s->b[0] = lanes_sub(one, s->on_warp);
  s->b[1] = s->on_warp;
  s->b[2] = lanes_sub(one, s->on_weft);
  s->b[3] = s->on_weft;
  LANES_UNROLL
  for (int yarn = 0; yarn < 2; ++yarn) {
    const int e = SLIP_FAR + 2 * yarn;
    LANES_UNROLL
    for (int n = 0; n < 3; ++n) s->at[e][n] = lanes_select(s->second[yarn], s->at[e + 1][n], s->at[e][n]);
    const lanes id = lanes_select(s->second[yarn], lanes_load((const int32_t *)s->id[e + 1]),
                                  lanes_load((const int32_t *)s->id[e]));
    lanes_store((int32_t *)s->id[e], id);
  }
}

/* From the weft's closest point to the warp's. */
LANES_INLINE void yarn_slip_lanes_gap(yarn_slip_lanes *s, lanes gap[3]) {
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    const lanes warp = lanes_sub(s->at[SLIP_FAR + 2][n], s->at[SLIP_WARP][n]);
    const lanes weft = lanes_sub(s->at[SLIP_FAR][n], s->at[SLIP_WEFT][n]);
    gap[n] = lanes_sub(lanes_add(s->at[SLIP_WARP][n], lanes64_round(lanes64_mul(warp, s->b[1]), 15)),
                       lanes_add(s->at[SLIP_WEFT][n], lanes64_round(lanes64_mul(weft, s->b[3]), 15)));
    s->far = yarn_slip_lanes_farther(s->far, gap[n]);
  }
}

LANES_INLINE void yarn_slip_lanes_tangent(const yarn_slip_lanes *s, int back, lanes half[3]) {
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) half[n] = lanes_asr(lanes_sub(s->way[back + 1][n], s->way[back][n]), 1);
}

/* The normal of the crossing, towards the side where the warp belongs. */
LANES_INLINE void yarn_slip_lanes_side(const yarn_slip_lanes *s, const lanes a[3], const lanes b[3],
                                       lanes side[3]) {
  const lane_mask under = yarn_slip_lanes_fact(s->facts, SLIP_UNDER);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    const int m = (n + 1) % 3;
    const int o = (n + 2) % 3;
    const lanes cross = lanes_sub(lanes_mul(a[m], b[o]), lanes_mul(a[o], b[m]));
    side[n] = lanes_select(under, lanes_sub(lanes_set(0), cross), cross);
  }
}

/* Which crossings are passed through clearly: they have all four springs, which meet at an angle above 30
 * degrees. */
LANES_INLINE lane_mask yarn_slip_lanes_is_behind(const yarn_slip_lanes *s, const lanes a[3],
                                                 const lanes b[3], const lanes side[3]) {
  const lane_mask aslant = lanes64_negative(
      lanes64_sub(lanes64_mul(lanes_asr(lanes_dot(a, a), 2), lanes_asr(lanes_dot(b, b), 2)),
                  lanes64_shr(lanes64_dot(side, side), 2)));
  const lanes none = lanes_asr(lanes_shl(s->facts, 24), 28); /* all four bits are 0: 0 */
  return mask_and_not(aslant, lanes_not_equal(none, lanes_set(0)));
}

/* The part of the slip that friction removes under a normal correction `pressed`. */
LANES_INLINE void yarn_slip_lanes_friction(const yarn_slip_view *v, yarn_slip_lanes *s,
                                           const lanes normal[3], lanes pressed, lanes back[3]) {
  lanes slip[3];
  lanes64 dot = lanes64_set(0);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    lanes64 sum = lanes64_set(0);
    LANES_UNROLL
    for (int e = 0; e < 4; ++e) {
      const uint32_t *id = s->id[yarn_slip_lanes_ends[e]];
      const lanes since = lanes_sub(s->at[yarn_slip_lanes_ends[e]][n], lanes_gather(v->predicted[n], id));
      const lanes moved = lanes_add(lanes_round(lanes_gather(v->speed[n], id), FX_SUB_BITS), since);
      s->far = yarn_slip_lanes_farther(s->far, moved);
      const lanes64 part = lanes64_mul(moved, s->b[e]);
      sum = e < 2 ? lanes64_add(sum, part) : lanes64_sub(sum, part);
    }
    slip[n] = lanes64_round(sum, 15);
    dot = lanes64_add(dot, lanes64_mul(slip[n], normal[n]));
  }
  const lanes along = lanes64_round(dot, 30);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) slip[n] = lanes_sub(slip[n], lanes_scale_unit(normal[n], along));
  const lanes limit = lanes_add(lanes_set(v->grip),
                                lanes64_low(lanes64_shr(lanes64_mul(pressed, lanes_set(v->friction)), 16)));
  const lanes64 squared = lanes64_dot(slip, slip);
  const lane_mask longer = lanes64_negative(lanes64_sub(lanes64_mul(limit, limit), squared));
  lanes m;
  const lanes_root root = lanes_rsqrt(squared, &m);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n)
    back[n] = lanes_select(longer, lanes_scale_unit(lanes_unit(root, slip[n]), limit), slip[n]);
}

/* The correction of the gap; returns the lanes whose velocity must not change. */
LANES_INLINE lane_mask yarn_slip_lanes_correction(const yarn_slip_view *v, yarn_slip_lanes *s,
                                                  lanes way[3]) {
  const lanes most = lanes_set(v->thickness / 4);
  const int64_t near = v->thickness / 16 + 1;
  const lanes nothing = lanes_set(0);
  lanes gap[3], warp[3], weft[3], side[3], normal[3], m;
  yarn_slip_lanes_gap(s, gap);
  yarn_slip_lanes_tangent(s, 2, warp);
  yarn_slip_lanes_tangent(s, 0, weft);
  yarn_slip_lanes_side(s, warp, weft, side);
  lanes64 squared = lanes64_dot(gap, gap);
  const lane_mask together = lanes64_negative(lanes64_sub(squared, lanes64_set(near * near)));
  const lanes64 ahead = lanes64_dot(gap, side);
  lane_mask through = lanes_greater(nothing, nothing);
  const lane_mask behind = lanes64_negative(ahead);
  if (mask_bits(behind) != 0) through = mask_and(behind, yarn_slip_lanes_is_behind(s, warp, weft, side));
  through = mask_and_not(through, together);
  if (mask_bits(together) != 0) {
    LANES_UNROLL
    for (int n = 0; n < 3; ++n) gap[n] = lanes_select(together, side[n], gap[n]);
    squared = lanes64_dot(gap, gap);
  }
  const lanes_root root = lanes_rsqrt(squared, &m);
  const lanes length = lanes_root_length(root, m);
  const lanes pulled =
      lanes_select(through, lanes_sub(nothing, most),
                   lanes_clamp(lanes_sub(lanes_set(v->thickness), length), v->thickness / 4));
  const lanes by = lanes_select(together, most, pulled);
  const lane_mask quiet = mask_or(together, through);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    normal[n] = lanes_unit(root, gap[n]);
    way[n] = lanes_scale_unit(normal[n], by);
  }
  if ((v->friction | v->grip) != 0) {
    lanes back[3];
    yarn_slip_lanes_friction(v, s, normal, lanes_abs(by), back);
    LANES_UNROLL
    for (int n = 0; n < 3; ++n) way[n] = lanes_sub(way[n], lanes_select(quiet, nothing, back[n]));
  }
  const lane_mask moves = mask_and(lanes_greater(lanes_set(INT32_MAX), s->least),
                                   mask_or(lanes_not_equal(lanes64_high(squared), nothing),
                                           lanes_not_equal(lanes64_low(squared), nothing)));
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    way[n] = lanes_or_zero(moves, way[n]);
    s->far = yarn_slip_lanes_farther(s->far, way[n]);
  }
  return quiet;
}

/* How a correction is distributed to the four ends. */
typedef struct {
  lanes share[4];     /* Q15 */
  lane_mask heavy[4]; /* a whole crossing */
  lane_mask last[4];  /* the end that takes the rounding remainder */
  lanes b_last, unit; /* of that end: weight, and velocity of one position step of half a crossing */
  uint32_t id[LANES];
} yarn_slip_lanes_weights;

LANES_INLINE void yarn_slip_lanes_weights_of(yarn_slip_lanes *s, yarn_slip_lanes_weights *k) {
  const lanes one = lanes_set(1);
  lanes ease[4] = {lanes_set(2), one, lanes_set(2), one};
  LANES_UNROLL
  for (int yarn = 0; yarn < 2; ++yarn) {
    const uint32_t bit = (uint32_t)SLIP_LIGHT << 2 * yarn;
    const lanes first = lanes_or_zero(yarn_slip_lanes_fact(s->facts, bit), one);
    const lanes second = lanes_or_zero(yarn_slip_lanes_fact(s->facts, bit << 1), one);
    const int e = yarn == 0 ? 3 : 1;
    ease[e] = lanes_add(one, lanes_select(s->second[yarn], second, first));
  }
  lanes sum = lanes_set(0);
  lanes most = lanes_mul(ease[0], s->b[0]);
  lanes last = lanes_set(0);
  lanes ids = lanes_load((const int32_t *)s->id[yarn_slip_lanes_ends[0]]);
  k->b_last = s->b[0];
  k->unit = lanes_set(1 << FX_SUB_BITS);
  LANES_UNROLL
  for (int n = 0; n < 4; ++n) {
    const lanes share = lanes_mul(ease[n], s->b[n]);
    const lane_mask more = lanes_greater(share, most);
    sum = lanes_add(sum, lanes_mul(ease[n], lanes_asr(lanes_mul(s->b[n], lanes_asr(s->b[n], 1)), 14)));
    most = lanes_max(most, share);
    last = lanes_select(more, lanes_set(n), last);
    k->b_last = lanes_select(more, s->b[n], k->b_last);
    k->unit = lanes_select(more, lanes_shl(ease[n], FX_SUB_BITS - 1), k->unit);
    ids = lanes_select(more, lanes_load((const int32_t *)s->id[yarn_slip_lanes_ends[n]]), ids);
  }
  lanes_store((int32_t *)k->id, ids);
  const lane_mask all = lanes_greater(one, lanes_set(0));
  lanes part[4];
  LANES_UNROLL
  for (int n = 0; n < 4; ++n) part[n] = lanes_mul(ease[n], s->b[n]);
  lanes_divide_q15(part, sum, k->share);
  LANES_UNROLL
  for (int n = 0; n < 4; ++n) {
    k->heavy[n] = lanes_greater(lanes_set(2), ease[n]);
    k->last[n] = mask_and_not(all, lanes_not_equal(last, lanes_set(n)));
  }
}

/* How far the ends move along an axis; `rest` is added to the last one. */
typedef struct {
  lanes moved[4], missing, rest;
} yarn_slip_lanes_step;

/* Moves the predicted positions of quiet lanes too, so that no velocity changes. */
LANES_INLINE void yarn_slip_lanes_move_predicted(const yarn_slip_view *v, const yarn_slip_lanes *s,
                                                 int axis, int end, lanes out, uint32_t quiet) {
  int32_t words[LANES];
  lanes_store(words, out);
  for (; quiet != 0; quiet &= quiet - 1u) {
    const uint32_t n = (uint32_t)__builtin_ctz(quiet);
    int32_t *predicted = &v->predicted[axis][s->id[end][n]];
    *predicted = fx_clamp(fx_wrap_add(*predicted, words[n]), -FX_WORLD_MAX, FX_WORLD_MAX);
  }
}

LANES_INLINE void yarn_slip_lanes_store(const yarn_slip_view *v, const yarn_slip_lanes *s,
                                        const yarn_slip_lanes_weights *k, int axis,
                                        const yarn_slip_lanes_step *t, lane_mask quiet) {
  lanes apart = lanes_set(0);
  LANES_UNROLL
  for (int n = 0; n < 4; ++n) {
    const int e = yarn_slip_lanes_ends[n];
    const lanes by = lanes_add(t->moved[n], lanes_or_zero(k->last[n], t->rest));
    const lanes momentum = lanes_add(by, lanes_or_zero(k->heavy[n], by));
    const lanes out = n < 2 ? by : lanes_sub(lanes_set(0), by);
    apart = n < 2 ? lanes_add(apart, momentum) : lanes_sub(apart, momentum);
    lanes_scatter(v->at[axis], s->id[e], lanes_add(s->at[e][axis], out));
    if (mask_bits(quiet) != 0)
      yarn_slip_lanes_move_predicted(v, s, axis, e, out, mask_bits(quiet) & s->alone);
  }
  const lanes speed = lanes_gather(v->speed[axis], k->id);
  const lanes change = lanes_mul(apart, k->unit);
  lanes_scatter(v->speed[axis], k->id, lanes_select(quiet, speed, lanes_sub(speed, change)));
}

LANES_INLINE void yarn_slip_lanes_move(const yarn_slip_view *v, const yarn_slip_lanes *s,
                                       const yarn_slip_lanes_weights *k, const lanes way[3],
                                       lane_mask quiet) {
  yarn_slip_lanes_step t[3];
  lanes n[3], d[3], quotient[3];
  lane_mask more = lanes_greater(lanes_set(0), lanes_set(0));
  LANES_UNROLL
  for (int axis = 0; axis < 3; ++axis) {
    lanes missing = lanes_shl(way[axis], 15);
    LANES_UNROLL
    for (int e = 0; e < 4; ++e) {
      t[axis].moved[e] = lanes64_round(lanes64_mul(way[axis], k->share[e]), 15);
      missing = lanes_sub(missing, lanes_mul(t[axis].moved[e], s->b[e]));
    }
    t[axis].missing = missing;
    d[axis] = k->b_last;
    n[axis] = lanes_add(lanes_abs(missing), lanes_asr(k->b_last, 1));
    more = mask_or(more, lanes_greater(n[axis], lanes_shl(d[axis], 5)));
  }
  if (mask_bits(more) != 0)
    lanes_divide_bits(n, d, 16, 3, quotient);
  else
    lanes_divide_bits(n, d, 6, 3, quotient);
  LANES_UNROLL
  for (int axis = 0; axis < 3; ++axis) {
    t[axis].rest = lanes_copy_sign(quotient[axis], t[axis].missing);
    yarn_slip_lanes_store(v, s, k, axis, &t[axis], quiet);
  }
}

/* Groups of LANES, until one is left to the scalar code. */
LANES_INLINE uint32_t yarn_slip_lanes_run(const yarn_slip_view *v, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first <= end);
  for (uint32_t at = first; at < end; at += LANES) {
    yarn_slip_lanes s;
    yarn_slip_lanes_weights k;
    lanes way[3];
    s.far = lanes_set(0);
    yarn_slip_lanes_load(v, at, end - at < (uint32_t)LANES ? end - at : (uint32_t)LANES, &s);
    yarn_slip_lanes_directions(&s);
    yarn_slip_lanes_closest(&s);
    const lane_mask quiet = yarn_slip_lanes_correction(v, &s, way);
    if (mask_bits(lanes_greater(s.far, lanes_set(YARN_SLIP_LANES_FAR))) != 0) return at - first;
    yarn_slip_lanes_weights_of(&s, &k);
    yarn_slip_lanes_move(v, &s, &k, way, quiet);
  }
  return end - first;
}
#endif

#endif
