/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/stage/zones.h"

#include "rt/model/couples.h"
#include "rt/model/heft.h"

enum { WEIGHT_BITS = 6, WEIGHT_MOST = (1 << 11) - 1 };

void zones_begin(fray_world *w) {
  for (uint32_t p = 0; p < w->particles; ++p) {
    w->ways[p].end = world_position(w, p);
    w->zone_of[p] = (row_id)p;
    w->stirred[p] = 0;
  }
  w->joined = 0;
  w->round = 1;
}

uint32_t zones_of(fray_world *w, uint32_t p) {
  uint32_t at = p;
  while (w->zone_of[at] != at) {
    w->zone_of[at] = w->zone_of[w->zone_of[at]];
    at = w->zone_of[at];
  }
  return at;
}

void zones_join(fray_world *w, uint32_t p, uint32_t q) {
  const uint32_t a = zones_of(w, p);
  const uint32_t b = zones_of(w, q);
  if (a < b)
    w->zone_of[b] = (row_id)a;
  else
    w->zone_of[a] = (row_id)b;
  w->joined = 1;
}

/* Of yarns in half crossings; of vertices 64ths of a particle, within what keeps sums in 64 bits. */
static int32_t weight_of(const fray_world *w, const heft *weighs, uint32_t p) {
  if (weighs->per_mass != 0)
    return fx_clamp(fx_asr(heft_at(weighs, p), HEFT_BITS - WEIGHT_BITS), 1, WEIGHT_MOST);
  return world_has_yarns(w) && couple_is_light(w, p) ? 1 : 2;
}

static int is_fixed(const fray_world *w, uint32_t p) {
  return p < (uint32_t)w->params->held || (world_has_layers(w) && w->stands[p] != 0);
}

/* Where it ends, without a speed. */
static void put(fray_world *w, uint32_t p, vec3 at) {
  w->qx[p] = fx_wrap_add(w->qx[p], fx_wrap_sub(at.x, w->x[p]));
  w->qy[p] = fx_wrap_add(w->qy[p], fx_wrap_sub(at.y, w->y[p]));
  w->qz[p] = fx_wrap_add(w->qz[p], fx_wrap_sub(at.z, w->z[p]));
  w->x[p] = at.x;
  w->y[p] = at.y;
  w->z[p] = at.z;
  w->stirred[p] = w->round;
}

static vec3 moved_of(const fray_world *w, uint32_t p) {
  return vec_sub(world_position(w, p), w->ways[p].begin);
}

static void weigh_zones(fray_world *w) {
  static const self_zone empty = {{0, 0, 0}, 0, {0, 0, 0}, 0, 0, SELF_NOBODY};
  const heft weighs = heft_of(w);
  for (uint32_t p = 0; p < w->particles; ++p) w->zones[p] = empty;
  for (uint32_t p = 0; p < w->particles; ++p) {
    self_zone *z = &w->zones[zones_of(w, p)];
    const vec3 moved = moved_of(w, p);
    const int32_t mass = weight_of(w, &weighs, p);
    ++z->members;
    if (is_fixed(w, p) && (z->held == SELF_NOBODY || (p >= (uint32_t)w->params->held && z->held < (uint32_t)w->params->held)))
      z->held = p; /* beside a body rather than in one's hands: who is held is where he is anyway */
    z->mass += mass;
    z->sum[0] += (int64_t)moved.x * mass;
    z->sum[1] += (int64_t)moved.y * mass;
    z->sum[2] += (int64_t)moved.z * mass;
  }
}

void zones_move(fray_world *w) {
  if (!w->joined) return;
  weigh_zones(w);
  for (uint32_t p = (uint32_t)w->params->held; p < w->particles; ++p) {
    const self_zone *z = &w->zones[zones_of(w, p)];
    if (z->members < 2 || is_fixed(w, p)) continue;
    vec3 by = vec_make((int32_t)(z->sum[0] / z->mass), (int32_t)(z->sum[1] / z->mass),
                       (int32_t)(z->sum[2] / z->mass));
    if (z->held != SELF_NOBODY) by = moved_of(w, z->held);
    put(w, p, vec_add(w->ways[p].begin, by));
    ++w->work.self_stops;
  }
}

static int within(int32_t a, int32_t b, int32_t most) {
  return (int64_t)a - b <= most && (int64_t)b - a <= most;
}

int zones_stay(const fray_world *w) {
  const int32_t most = w->selves->slack;
  for (uint32_t p = 0; p < w->particles; ++p) {
    const vec3 end = w->ways[p].end;
    if (!within(w->x[p], end.x, most) || !within(w->y[p], end.y, most) || !within(w->z[p], end.z, most))
      return 0;
  }
  return 1;
}

FX_WRAPS static int64_t wrap_add64(int64_t a, int64_t b) { return (int64_t)((uint64_t)a + (uint64_t)b); }

/* About the mean, by the weights of places, which keep the sum in 64 bits. */
static void find_means(fray_world *w) {
  const heft weighs = heft_of(w);
  for (uint32_t p = 0; p < w->particles; ++p) {
    self_zone *z = &w->zones[p];
    z->sum[0] = z->sum[1] = z->sum[2] = z->whole = 0;
    z->mass = 0;
    z->held = SELF_NOBODY; /* here the heaviest */
  }
  for (uint32_t p = (uint32_t)w->params->held; p < w->particles; ++p) {
    self_zone *z = &w->zones[zones_of(w, p)];
    const int32_t weight = weight_of(w, &weighs, p);
    z->mass += weight;
    z->sum[0] += (int64_t)w->vx[p] * weight;
    z->sum[1] += (int64_t)w->vy[p] * weight;
    z->sum[2] += (int64_t)w->vz[p] * weight;
    z->whole += (int64_t)w->sheet.mass[p];
    if (z->held == SELF_NOBODY || w->sheet.mass[z->held] < w->sheet.mass[p]) z->held = p;
  }
  for (uint32_t p = 0; p < w->particles; ++p) {
    self_zone *z = &w->zones[p];
    for (uint32_t k = 0; k < 3 && z->mass != 0; ++k) {
      z->mean[k] = (int32_t)(z->sum[k] / z->mass);
      z->sum[k] = 0; /* from here on the momentum that is lacking */
    }
  }
}

static int is_slowed(const self_zone *z) {
  const int32_t most = FX_SPEED_MAX / 2;
  for (uint32_t k = 0; k < 3; ++k)
    if (z->mean[k] < -most || z->mean[k] > most) return 0;
  return z->members > 1;
}

static void take_mean(fray_world *w, int32_t *speed, uint32_t k) {
  for (uint32_t p = (uint32_t)w->params->held; p < w->particles; ++p) {
    self_zone *z = &w->zones[zones_of(w, p)];
    if (!is_slowed(z)) continue;
    z->sum[k] = wrap_add64(z->sum[k], (int64_t)w->sheet.mass[p] * ((int64_t)speed[p] - z->mean[k]));
    speed[p] = z->mean[k];
  }
}

/* To all of a zone, then to its heaviest, then to the next. */
static void give_back(fray_world *w, int32_t *speed, uint32_t k) {
  int32_t *owed = &w->sheet.state->owed[k];
  for (uint32_t p = (uint32_t)w->params->held; p < w->particles; ++p) {
    const self_zone *z = &w->zones[zones_of(w, p)];
    if (is_slowed(z)) speed[p] = fx_saturate(speed[p] + z->sum[k] / z->whole);
  }
  for (uint32_t p = 0; p < w->particles; ++p) {
    const self_zone *z = &w->zones[p];
    if (w->zone_of[p] != p || z->mass == 0 || !is_slowed(z)) continue;
    const int64_t mass = (int64_t)w->sheet.mass[z->held];
    const int64_t rest = z->sum[k] % z->whole + *owed;
    const int64_t more = rest / mass;
    speed[z->held] = fx_saturate(speed[z->held] + more);
    *owed = (int32_t)(rest - more * mass);
  }
}

void zones_slow(fray_world *w) {
  int32_t *const speeds[3] = {w->vx, w->vy, w->vz};
  if (!w->joined) return;
  find_means(w);
  for (uint32_t k = 0; k < 3; ++k) {
    take_mean(w, speeds[k], k);
    give_back(w, speeds[k], k);
  }
}

void zones_join_all(fray_world *w) {
  w->state->faults |= (int32_t)FRAY_FAULT_SELVES;
  for (uint32_t p = (uint32_t)w->params->held; p < w->particles; ++p)
    zones_join(w, (uint32_t)w->params->held, p);
  zones_move(w);
}
