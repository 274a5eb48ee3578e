/* SPDX-License-Identifier: Apache-2.0 */
/* A vertex and a triangle, or two sides, that meet in a tick: a push, an impulse, and whether they still touch.
 * The places of the two that are nearest are sums of corners by weights, which add up to one for each; with a
 * minus for the first, one sum tells the gap between them. */
#include "rt/model/heft.h"
#include "rt/stage/layers.h"

enum { SHARE_BITS = 16, SHARE_MOST = 1 << SHARE_BITS, RATIO_MOST = 4 << SHARE_BITS };

layer_meeting layers_meeting(const fray_world *w, const layer_pair *pair) {
  layer_meeting m;
  for (uint32_t n = 0; n < 4; ++n) {
    m.way[n].begin = w->ways[pair->p[n]].begin;
    m.way[n].end = world_position(w, pair->p[n]);
  }
  return m;
}

sweep_gap layers_gap(const fray_world *w, const layer_pair *pair) {
  const layer_meeting m = layers_meeting(w, pair);
  return layer_firsts(pair) == 2 ? sweep_gap_edges(&m.way[0], &m.way[2]) : sweep_gap_point_triangle(&m.way[0], &m.way[1]);
}

static int sweep(fray_world *w, const layer_pair *pair, const layer_meeting *m, int32_t thickness, sweep_contact *c) {
  ++w->work.self_sweeps;
  return layer_firsts(pair) == 2 ? sweep_edges(&m->way[0], &m->way[2], thickness, c)
                          : sweep_point_triangle(&m->way[0], &m->way[1], thickness, c);
}

/* Q15 of each corner in the way from the first's point to the second's. */
static void weights_of(const layer_pair *pair, const sweep_contact *c, int32_t b[4]) {
  if (layer_firsts(pair) == 2) {
    b[0] = c->at[0] - SWEEP_ONE;
    b[1] = -c->at[0];
    b[2] = SWEEP_ONE - c->at[1];
    b[3] = c->at[1];
  } else {
    b[0] = -SWEEP_ONE;
    b[1] = SWEEP_ONE - c->at[0] - c->at[1];
    b[2] = c->at[0];
    b[3] = c->at[1];
  }
}

/* Beside the first corner, so that differences fit. */
static int32_t gap_along(const vec3 at[4], const int32_t b[4], vec3 normal) {
  int64_t sum[3] = {0, 0, 0};
  for (uint32_t n = 1; n < 4; ++n) {
    const vec3 way = vec_sub(at[n], at[0]);
    sum[0] = fx_add64(sum[0], fx_mul_wide(way.x, b[n]));
    sum[1] = fx_add64(sum[1], fx_mul_wide(way.y, b[n]));
    sum[2] = fx_add64(sum[2], fx_mul_wide(way.z, b[n]));
  }
  const vec3 gap = vec_make(fx_saturate(fx_round64(sum[0], 15)), fx_saturate(fx_round64(sum[1], 15)),
                            fx_saturate(fx_round64(sum[2], 15)));
  return vec_dot_unit(gap, normal);
}

static int is_held(const fray_world *w, uint32_t p) { return p < (uint32_t)w->params->held; }

/* ---- the impulse ---- */

/* By how much of the speed along the normal each one's is changed, Q16: by weight over mass. */
static int ratios_of(const fray_world *w, const layer_pair *pair, const int32_t b[4], int32_t ratio[4]) {
  int64_t of[4];
  int64_t whole = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    of[n] = is_held(w, pair->p[n]) ? 0 : fx_round64(fx_mul_wide(w->inverse[pair->p[n]], b[n]), 15);
    whole = fx_add64(whole, fx_round64(fx_mul_wide((int32_t)of[n], b[n]), 15));
  }
  if (whole <= 0) return 0;
  for (uint32_t n = 0; n < 4; ++n)
    ratio[n] = (int32_t)fx_clamp64(of[n] * SHARE_MOST / whole, -RATIO_MOST, RATIO_MOST);
  return 1;
}

static int64_t speed_along(const fray_world *w, const layer_pair *pair, const int32_t b[4], vec3 normal) {
  int64_t sum = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    const uint32_t p = pair->p[n];
    sum = fx_add64(sum, fx_mul_wide(vec_dot_unit(vec_make(w->vx[p], w->vy[p], w->vz[p]), normal), b[n]));
  }
  return fx_round64(sum, 15);
}

/* Who makes up for what rounding leaves: the heaviest that is not held; 4: all are. */
static uint32_t heaviest_of(const fray_world *w, const layer_pair *pair) {
  uint32_t found = 4;
  for (uint32_t n = 0; n < 4; ++n)
    if (!is_held(w, pair->p[n]) && (found == 4 || w->sheet.mass[pair->p[n]] > w->sheet.mass[pair->p[found]])) found = n;
  return found;
}

static int64_t divided(int64_t whole, int64_t by) {
  return whole < 0 ? -((by / 2 - whole) / by) : (whole + by / 2) / by;
}

/* Along one axis. Returns what the sheet gained, vertex masses times speed: what bodies that hold of it lose. */
static int64_t change_axis(fray_world *w, const layer_pair *pair, const int32_t change[4], uint32_t last, int32_t *speed,
                           int32_t *owed, int kept) {
  int64_t gained = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    const uint32_t p = pair->p[n];
    if (is_held(w, p) || (kept && n == last)) continue;
    speed[p] = fx_add(speed[p], change[n]);
    gained = fx_add64(gained, (int64_t)w->sheet.mass[p] * change[n]);
  }
  if (!kept) return gained;
  const uint32_t p = pair->p[last];
  const int64_t mass = (int64_t)w->sheet.mass[p];
  const int64_t lost = fx_add64(gained, -(int64_t)*owed);
  const int64_t back = divided(lost, mass);
  *owed = (int32_t)(back * mass - lost);
  speed[p] = fx_add(speed[p], (int32_t)-back);
  return 0;
}

static int is_too_fast(const fray_world *w, const layer_pair *pair) {
  const uint32_t most = (uint32_t)FX_SPEED_MAX / 2u;
  for (uint32_t n = 0; n < 4; ++n) {
    const uint32_t p = pair->p[n];
    if (fx_magnitude(w->vx[p]) > most || fx_magnitude(w->vy[p]) > most || fx_magnitude(w->vz[p]) > most) return 1;
  }
  return 0;
}

static void give_body(fray_world *w, const layer_pair *pair, const int64_t gained[3]) {
  uint32_t n = 0;
  while (!is_held(w, pair->p[n])) ++n;
  const int64_t unit = w->cloths->unit;
  body_gave(&w->motion[w->grip_body[pair->p[n]]], gained[0] / unit, gained[1] / unit, gained[2] / unit);
}

/* What they approach by is taken away: they part or go on together. Those that are `pushed` go on together: at the
 * end of its tick what has met something may swing back already, and would gain by each push. */
static void stop_approach(fray_world *w, const layer_pair *pair, const int32_t b[4], const int32_t ratio[4], vec3 normal,
                          int pushed) {
  int32_t change[3][4];
  int64_t gained[3];
  const int64_t speed = speed_along(w, pair, b, normal);
  const uint32_t last = heaviest_of(w, pair);
  int kept = 1;
  if ((speed >= 0 && !pushed) || last == 4 || is_too_fast(w, pair)) return;
  const int32_t amount = (int32_t)fx_clamp64(-speed, -FX_SPEED_MAX / 16, FX_SPEED_MAX / 16);
  for (uint32_t n = 0; n < 4; ++n) {
    const vec3 by = vec_scale_unit(normal, (int32_t)fx_round64(fx_mul_wide(amount, ratio[n]), SHARE_BITS));
    change[0][n] = by.x;
    change[1][n] = by.y;
    change[2][n] = by.z;
    kept = kept && !is_held(w, pair->p[n]);
  }
  int32_t *const speeds[3] = {w->vx, w->vy, w->vz};
  for (uint32_t k = 0; k < 3; ++k)
    gained[k] = change_axis(w, pair, change[k], last, speeds[k], &w->sheet.state->owed[k], kept);
  if (!kept) give_body(w, pair, gained);
}

/* ---- the push ---- */

static void move_by(fray_world *w, uint32_t p, vec3 by) {
  w->x[p] = fx_add(w->x[p], by.x);
  w->y[p] = fx_add(w->y[p], by.y);
  w->z[p] = fx_add(w->z[p], by.z);
  w->qx[p] = fx_add(w->qx[p], by.x);
  w->qy[p] = fx_add(w->qy[p], by.y);
  w->qz[p] = fx_add(w->qz[p], by.z);
  w->stirred[p] = w->round;
}

/* Nobody of it has been put anywhere since the last look. */
static int is_still(const fray_world *w, const layer_pair *pair) {
  const uint8_t *round = w->stirred;
  const uint8_t last = pair->looked;
  return round[pair->p[0]] < last && round[pair->p[1]] < last && round[pair->p[2]] < last && round[pair->p[3]] < last;
}

int layers_push(fray_world *w, layer_pair *pair) {
  if (is_still(w, pair)) return 0;
  const layer_meeting m = layers_meeting(w, pair);
  const vec3 begin[4] = {m.way[0].begin, m.way[1].begin, m.way[2].begin, m.way[3].begin};
  const vec3 end[4] = {m.way[0].end, m.way[1].end, m.way[2].end, m.way[3].end};
  const int32_t thickness = w->selves->thickness;
  int32_t b[4];
  int32_t share[4];
  sweep_contact c;
  pair->looked = w->round;
  pair->near = 0;
  if (!sweep(w, pair, &m, thickness, &c)) return 0;
  pair->near = 1;
  weights_of(pair, &c, b);
  /* those that began nearer than that part slowly */
  int32_t wanted = thickness;
  if (c.time == 0) wanted = fx_clamp(gap_along(begin, b, c.normal), 0, thickness - thickness / 128) + thickness / 128;
  const int64_t missing = (int64_t)wanted - gap_along(end, b, c.normal);
  if (!ratios_of(w, pair, b, share)) return 0;
  stop_approach(w, pair, b, share, c.normal, missing > 0);
  if (missing <= 0 || missing > thickness) return 0;
  const int32_t by = (int32_t)(missing < FX_LU / 8 ? missing : FX_LU / 8);
  for (uint32_t n = 0; n < 4; ++n)
    if (share[n] != 0)
      move_by(w, pair->p[n], vec_scale_unit(c.normal, (int32_t)fx_round64(fx_mul_wide(by, share[n]), SHARE_BITS)));
  return 1;
}

/* ---- touching ---- */

static int64_t along(vec3 from, vec3 to, vec3 normal) {
  const vec3 way = vec_sub(to, from);
  return fx_add64(fx_add64(fx_mul_wide(way.x, normal.x), fx_mul_wide(way.y, normal.y)), fx_mul_wide(way.z, normal.z));
}

/* The second is beyond the first along the normal at begin and end, and so in between. */
static int is_beyond(const layer_pair *pair, const layer_meeting *m, vec3 normal) {
  const uint32_t as = layer_firsts(pair);
  int64_t most[2] = {0, 0};
  if (as == 2) {
    most[0] = along(m->way[0].begin, m->way[1].begin, normal);
    most[1] = along(m->way[0].end, m->way[1].end, normal);
  }
  for (uint32_t n = as; n < 4; ++n) {
    const int64_t b = along(m->way[0].begin, m->way[n].begin, normal);
    const int64_t e = along(m->way[0].end, m->way[n].end, normal);
    if (b <= 0 || b <= most[0] || e <= 0 || e <= most[1]) return 0;
  }
  return 1;
}

int layers_touch(fray_world *w, layer_pair *pair) {
  if (is_still(w, pair) && !pair->near) return 0;
  const layer_meeting m = layers_meeting(w, pair);
  sweep_contact c;
  pair->looked = w->round;
  pair->near = 0;
  if (!sweep(w, pair, &m, 0, &c)) return 0;
  pair->near = !is_beyond(pair, &m, c.normal);
  return pair->near;
}
