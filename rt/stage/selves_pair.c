/* SPDX-License-Identifier: Apache-2.0 */
/* Two segments that meet in a tick: a push, an impulse, and whether they still touch. */
#include "rt/model/couples.h"
#include "rt/stage/selves.h"

self_meeting selves_meeting(const fray_world *w, uint32_t row_a, uint32_t row_b) {
  self_meeting m = {{{w->row_i[row_a], w->row_j[row_a]}, {w->row_i[row_b], w->row_j[row_b]}}, {{{{0, 0, 0}, {0, 0, 0}}}}};
  for (uint32_t n = 0; n < 2; ++n)
    for (uint32_t k = 0; k < 2; ++k) {
      m.way[n][k].begin = w->ways[m.p[n][k]].begin;
      m.way[n][k].end = world_position(w, m.p[n][k]);
    }
  return m;
}

int selves_stay_apart(const self_meeting *m, int32_t by) {
  const self_way of[4] = {{m->way[0][0].begin, m->way[0][0].end}, {m->way[0][1].begin, m->way[0][1].end},
                          {m->way[1][0].begin, m->way[1][0].end}, {m->way[1][1].begin, m->way[1][1].end}};
  return selves_ways_apart(&of[0], &of[1], &of[2], &of[3], by);
}

static vec3 point_on(vec3 a, vec3 b, int32_t at) {
  const vec3 way = vec_sub(b, a);
  return vec_add(a, vec_make((int32_t)fx_round64(fx_mul_wide(way.x, at), 15),
                             (int32_t)fx_round64(fx_mul_wide(way.y, at), 15),
                             (int32_t)fx_round64(fx_mul_wide(way.z, at), 15)));
}

/* From the first's point to the second's, along the normal. */
static int32_t gap_begin(const self_meeting *m, const sweep_contact *c) {
  const vec3 a = point_on(m->way[0][0].begin, m->way[0][1].begin, c->at[0]);
  const vec3 b = point_on(m->way[1][0].begin, m->way[1][1].begin, c->at[1]);
  return vec_dot_unit(vec_sub(b, a), c->normal);
}
static int32_t gap_end(const self_meeting *m, const sweep_contact *c) {
  const vec3 a = point_on(m->way[0][0].end, m->way[0][1].end, c->at[0]);
  const vec3 b = point_on(m->way[1][0].end, m->way[1][1].end, c->at[1]);
  return vec_dot_unit(vec_sub(b, a), c->normal);
}

/* Twice the inverse mass, in whole crossings: 2 light, 1 whole, 0 held. */
static int32_t ease_of(const fray_world *w, uint32_t p) {
  if (p < (uint32_t)w->params->held) return 0;
  return world_has_yarns(w) && couple_is_light(w, p) ? 2 : 1;
}

static int32_t faster(int32_t v, int32_t by) {
  return (int32_t)fx_clamp64((int64_t)v + by, -FX_SPEED_MAX, FX_SPEED_MAX);
}

/* A segment gets an even momentum, in half crossings, each end an even part of it. */
static void push_segment(fray_world *w, const uint32_t ends[2], int32_t at, vec3 half) {
  const vec3 far = vec_make((int32_t)fx_round64(fx_mul_wide(half.x, at), 15),
                            (int32_t)fx_round64(fx_mul_wide(half.y, at), 15),
                            (int32_t)fx_round64(fx_mul_wide(half.z, at), 15));
  const vec3 parts[2] = {vec_sub(half, far), far};
  for (uint32_t n = 0; n < 2; ++n) {
    const uint32_t p = ends[n];
    const int32_t ease = ease_of(w, p);
    if (ease == 0) {
      body_gave(&w->motion[w->grip_body[p]], -(int64_t)parts[n].x, -(int64_t)parts[n].y,
                -(int64_t)parts[n].z);
      continue;
    }
    w->vx[p] = faster(w->vx[p], parts[n].x * ease);
    w->vy[p] = faster(w->vy[p], parts[n].y * ease);
    w->vz[p] = faster(w->vz[p], parts[n].z * ease);
  }
}

static int64_t speed_along(const fray_world *w, const self_meeting *m, const sweep_contact *c) {
  int64_t sum = 0;
  for (uint32_t n = 0; n < 2; ++n)
    for (uint32_t k = 0; k < 2; ++k) {
      const uint32_t p = m->p[n][k];
      const int32_t share = k == 0 ? SLIP_ONE - c->at[n] : c->at[n];
      const int64_t v = vec_dot_unit(vec_make(w->vx[p], w->vy[p], w->vz[p]), c->normal);
      sum += (n == 0 ? -v : v) * share;
    }
  return fx_round64(sum, 15);
}

/* Of ease b^2, Q15. */
static int32_t ease_along(const fray_world *w, const self_meeting *m, const sweep_contact *c) {
  int32_t sum = 0;
  for (uint32_t n = 0; n < 2; ++n)
    for (uint32_t k = 0; k < 2; ++k) {
      const int32_t share = k == 0 ? SLIP_ONE - c->at[n] : c->at[n];
      sum += ease_of(w, m->p[n][k]) * fx_asr(share * (share / 2), 14);
    }
  return sum;
}

/* What they approach by is taken away: they part or go on together. */
static void stop_approach(fray_world *w, const self_meeting *m, const sweep_contact *c) {
  const int64_t speed = speed_along(w, m, c);
  const int32_t ease = ease_along(w, m, c);
  if (speed >= 0 || ease < SLIP_ONE / 8) return;
  const int32_t amount = fx_saturate(-speed * SLIP_ONE / ease);
  const vec3 half = vec_scale_unit(c->normal, fx_min(amount, FX_SPEED_MAX / 4));
  push_segment(w, m->p[0], c->at[0], vec_make(-half.x, -half.y, -half.z));
  push_segment(w, m->p[1], c->at[1], half);
}

/* 1 where neither has been put anywhere since the last look. */
static int is_still(const fray_world *w, const self_pair *pair) {
  const uint8_t *round = w->stirred;
  const uint8_t last = pair->looked;
  return round[w->row_i[pair->a]] < last && round[w->row_j[pair->a]] < last &&
         round[w->row_i[pair->b]] < last && round[w->row_j[pair->b]] < last;
}

int selves_push(fray_world *w, self_pair *pair) {
  if (is_still(w, pair)) return 0;
  const self_meeting m = selves_meeting(w, pair->a, pair->b);
  const int32_t thickness = w->selves->thickness;
  sweep_contact c;
  pair->looked = w->round;
  pair->near = 0;
  if (selves_stay_apart(&m, thickness)) return 0;
  ++w->work.self_sweeps;
  if (!sweep_edges(m.way[0], m.way[1], thickness, &c)) return 0;
  pair->near = 1;
  /* those that began nearer than that part slowly */
  int32_t wanted = thickness;
  if (c.time == 0) wanted = fx_clamp(gap_begin(&m, &c), 0, thickness - thickness / 8) + thickness / 8;
  const int64_t missing = (int64_t)wanted - gap_end(&m, &c);
  stop_approach(w, &m, &c);
  if (missing <= 0) return 0;
  const vec3 by = vec_scale_unit(c.normal, (int32_t)(missing < FX_LU / 8 ? missing : FX_LU / 8));
  const slip_pair ends = {{m.p[1][0], m.p[1][1], m.p[0][0], m.p[0][1]},
                          {SLIP_ONE - c.at[1], c.at[1], SLIP_ONE - c.at[0], c.at[0]}};
  if (!slip_move(w, &ends, by, 1)) return 0;
  for (uint32_t n = 0; n < 4; ++n) w->stirred[ends.p[n]] = w->round;
  return 1;
}

static int64_t along(vec3 from, vec3 to, vec3 normal) { return zones_dot(vec_sub(to, from), normal); }

/* One is beyond the other along the normal at begin and end, and so in between. */
static int is_beyond(const self_meeting *m, vec3 normal) {
  const vec3 begin = m->way[0][0].begin;
  const vec3 end = m->way[0][0].end;
  const int64_t most[2] = {along(begin, m->way[0][1].begin, normal), along(end, m->way[0][1].end, normal)};
  for (uint32_t k = 0; k < 2; ++k) {
    const int64_t b = along(begin, m->way[1][k].begin, normal);
    const int64_t e = along(end, m->way[1][k].end, normal);
    if (b <= 0 || b <= most[0] || e <= 0 || e <= most[1]) return 0;
  }
  return 1;
}

int selves_touch(fray_world *w, self_pair *pair) {
  if (is_still(w, pair) && !pair->near) return 0;
  const self_meeting m = selves_meeting(w, pair->a, pair->b);
  sweep_contact c;
  pair->looked = w->round;
  pair->near = 0;
  if (selves_stay_apart(&m, 0)) return 0;
  ++w->work.self_sweeps;
  if (!sweep_edges(m.way[0], m.way[1], 0, &c)) return 0;
  pair->near = !is_beyond(&m, c.normal);
  return pair->near;
}
