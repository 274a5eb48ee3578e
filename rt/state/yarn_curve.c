/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/state/yarn_curve.h"

#include "rt/state/yarn_touch.h"

enum { HALF = YARN_PLACE_HALF };

yarn_line yarn_line_of(const fray_world *w, uint32_t axis, uint32_t number) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t wefts = (uint32_t)w->params->wefts;
  FRAY_ASSERT(axis <= (uint32_t)FRAY_WARP && number < (axis == (uint32_t)FRAY_WARP ? warps : wefts));
  if (axis == (uint32_t)FRAY_WARP) {
    const yarn_line warp = {w->woven.warp_particle, number, warps, wefts * (warps - 1u) + number, warps,
                            wefts - 1u};
    return warp;
  }
  const yarn_line weft = {w->woven.crossing_particle, number * warps, 1, number * (warps - 1u), 1,
                          warps - 1u};
  return weft;
}

int yarn_line_holds(const fray_world *w, const yarn_line *line, uint32_t k) {
  FRAY_ASSERT(k < line->last);
  return w->woven.spring_kind[w->woven.spring_of[line->link + k * line->link_stride]] != SPRING_DEAD;
}

static uint32_t particle_at(const yarn_line *line, uint32_t k) {
  return line->particle[line->crossing + k * line->stride];
}

/* Elastic yarns: where the particle would be when contacts act next. */
static vec3 position_at(const fray_world *w, uint32_t p) {
  const vec3 at = world_position(w, p);
  if (!world_has_elastic_yarns(w)) return at;
  const vec3 way = vec_round(world_velocity(w, p), FX_SUB_BITS + yarn_slip_bits(w));
  return vec_clamp(vec_add(at, way), FX_EDGE_MAX);
}

static vec3 scaled(vec3 v, int32_t weight) {
  return vec_make(fx_mul_round(v.x, weight, YARN_PLACE_BITS), fx_mul_round(v.y, weight, YARN_PLACE_BITS),
                  fx_mul_round(v.z, weight, YARN_PLACE_BITS));
}

/* s^2 / 2, Q20 of Q20. */
static int32_t half_square(int32_t s) { return fx_mul_round(s, s, YARN_PLACE_BITS + 1); }

/* 1 iff the yarn goes on to s from its particle. */
static int reaches(int32_t s, uint32_t goes) {
  if (goes == 0) return 0;
  return (s <= YARN_PLACE_BEYOND || (goes & (uint32_t)YARN_GOES_ON) != 0) &&
         (s >= -YARN_PLACE_BEYOND || (goes & (uint32_t)YARN_GOES_BACK) != 0);
}

int yarn_spot_find(const fray_world *w, const yarn_line *line, uint32_t place, yarn_spot *spot) {
  const uint32_t k = place >> YARN_PLACE_BITS;
  const int32_t s = yarn_place_past(place);
  FRAY_ASSERT(k <= line->last);
  const int back = k > 0 && yarn_line_holds(w, line, k - 1u);
  const int on = k < line->last && yarn_line_holds(w, line, k);
  spot->goes = (back ? (uint32_t)YARN_GOES_BACK : 0u) | (on ? (uint32_t)YARN_GOES_ON : 0u);
  if (!reaches(s, spot->goes)) return 0;
  spot->particle[1] = particle_at(line, k);
  spot->particle[0] = back ? particle_at(line, k - 1u) : spot->particle[1];
  spot->particle[2] = on ? particle_at(line, k + 1u) : spot->particle[1];
  spot->nearest = k;
  spot->weight[0] = !back ? 0 : on ? half_square(HALF - s) : -s;
  spot->weight[1] = !on ? 0 : back ? half_square(HALF + s) : s;
  spot->on_share = !on ? 0 : back ? HALF + s : YARN_PLACE_ONE;
  return 1;
}

int yarn_spot_at(const fray_world *w, const yarn_line *line, uint32_t place, yarn_spot *spot) {
  if (!yarn_spot_find(w, line, place, spot)) return 0;
  const vec3 at = position_at(w, spot->particle[1]);
  const vec3 before = vec_sub(at, position_at(w, spot->particle[0]));
  const vec3 after = vec_sub(position_at(w, spot->particle[2]), at);
  spot->at = vec_add(at, vec_sub(scaled(after, spot->weight[1]), scaled(before, spot->weight[0])));
  spot->along = vec_add(scaled(before, YARN_PLACE_ONE - spot->on_share), scaled(after, spot->on_share));
  return 1;
}
