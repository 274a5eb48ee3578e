/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns do not pass through each other (Metaaphanon 2009, section 4.2, equation 5; how a collision is
 * answered is ours, after Bridson et al. 2002). Segments of yarns are the living structural links; those
 * that share a particle, or a crossing whose yarns hold each other, are the weave's own, which slip keeps.
 *
 * Once a tick, behind its last substep, when all have split and been cut that will: every particle went
 * straight from where the tick began to where it is now. If nothing touched on these ways at any time,
 * then no yarn has passed another, whatever the substeps did in between. So:
 *
 *   find    all segments that may come near each other (selves_near.c)
 *   push    those that come nearer than the thickness, a few rounds, and take away the speed at which
 *           they approach; positions alone, so that the push itself gives nobody a speed
 *   join    what touches on its way nevertheless: both move as one, by their mean, from where the tick
 *           began, where they did not touch; a few rounds, then all that were near each other
 *
 * What was put farther from its way than the slack that the search allowed for is looked at again, all
 * of it. If that does not end the whole sheet moves as one for this tick, and FRAY_FAULT_SELVES says so.
 * Speeds stay as the pushes left them, so momentum is kept to the last bit in each case.
 * Held particles are where their bodies have them: bodies that carry yarns through each other are
 * reported, not stopped. */
#include "rt/stage/selves.h"

#include "rt/model/couples.h"
#include "rt/stage/stage.h"

void selves_begin(fray_world *w) {
  if (!world_has_selves(w)) return;
  for (uint32_t p = 0; p < w->particles; ++p) w->ways[p].begin = world_position(w, p);
  w->began = w->particles;
}

uint32_t selves_zone_of(fray_world *w, uint32_t p) {
  uint32_t at = p;
  while (w->zone_of[at] != at) {
    w->zone_of[at] = w->zone_of[w->zone_of[at]];
    at = w->zone_of[at];
  }
  return at;
}

static void join_two(fray_world *w, uint32_t p, uint32_t q) {
  const uint32_t a = selves_zone_of(w, p);
  const uint32_t b = selves_zone_of(w, q);
  if (a < b)
    w->zone_of[b] = (row_id)a;
  else
    w->zone_of[a] = (row_id)b;
  w->joined = 1;
}

void selves_join(fray_world *w, const self_pair *pair) {
  join_two(w, w->row_i[pair->a], w->row_j[pair->a]);
  join_two(w, w->row_i[pair->b], w->row_j[pair->b]);
  join_two(w, w->row_i[pair->a], w->row_i[pair->b]);
}

static int is_joined(fray_world *w, const self_pair *pair) {
  const uint32_t zone = selves_zone_of(w, w->row_i[pair->a]);
  return selves_zone_of(w, w->row_j[pair->a]) == zone && selves_zone_of(w, w->row_i[pair->b]) == zone &&
         selves_zone_of(w, w->row_j[pair->b]) == zone;
}

static int32_t mass_of(const fray_world *w, uint32_t p) {
  return world_has_yarns(w) && couple_is_light(w, p) ? 1 : 2;
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
  static const self_zone empty = {{0, 0, 0}, 0, 0, SELF_NOBODY};
  for (uint32_t p = 0; p < w->particles; ++p) w->zones[p] = empty;
  for (uint32_t p = 0; p < w->particles; ++p) {
    self_zone *z = &w->zones[selves_zone_of(w, p)];
    const vec3 moved = moved_of(w, p);
    const int32_t mass = mass_of(w, p);
    ++z->members;
    if (p < (uint32_t)w->params->held && z->held == SELF_NOBODY) z->held = p;
    z->mass += mass;
    z->sum[0] += (int64_t)moved.x * mass;
    z->sum[1] += (int64_t)moved.y * mass;
    z->sum[2] += (int64_t)moved.z * mass;
  }
}

/* All of a zone by its mean, or as the body moves that holds some of it. */
static void move_zones(fray_world *w) {
  if (!w->joined) return;
  weigh_zones(w);
  for (uint32_t p = (uint32_t)w->params->held; p < w->particles; ++p) {
    const self_zone *z = &w->zones[selves_zone_of(w, p)];
    if (z->members < 2) continue;
    vec3 by = vec_make((int32_t)(z->sum[0] / z->mass), (int32_t)(z->sum[1] / z->mass),
                       (int32_t)(z->sum[2] / z->mass));
    if (z->held != SELF_NOBODY) by = moved_of(w, z->held);
    put(w, p, vec_add(w->ways[p].begin, by));
    ++w->work.self_stops;
  }
}

static void begin_pass(fray_world *w) {
  for (uint32_t p = 0; p < w->particles; ++p) {
    w->ways[p].end = world_position(w, p);
    w->zone_of[p] = (row_id)p;
    w->stirred[p] = 0;
  }
  w->joined = 0;
  w->round = 1;
}

static void push_pairs(fray_world *w) {
  int pushed = 1;
  for (uint32_t round = 0; round < SELVES_ROUNDS && pushed; ++round) {
    pushed = 0;
    ++w->round;
    for (uint32_t n = 0; n < w->pair_count; ++n) pushed |= selves_push(w, &w->pairs[n]);
  }
}

static int join_touching(fray_world *w) {
  int touch = 0;
  ++w->round;
  for (uint32_t n = 0; n < w->pair_count; ++n) {
    if (is_joined(w, &w->pairs[n]) || !selves_touch(w, &w->pairs[n])) continue;
    selves_join(w, &w->pairs[n]);
    touch = 1;
  }
  return touch;
}

static void join_pairs(fray_world *w) {
  move_zones(w);
  for (uint32_t round = 0; round < SELVES_MERGES; ++round) {
    if (!join_touching(w)) return;
    move_zones(w);
  }
  for (uint32_t n = 0; n < w->pair_count; ++n) {
    selves_join(w, &w->pairs[n]);
    join_two(w, w->row_i[w->pairs[0].a], w->row_i[w->pairs[n].a]);
  }
  move_zones(w);
}

static int within(int32_t a, int32_t b, int32_t most) {
  return (int64_t)a - b <= most && (int64_t)b - a <= most;
}
/* Where the search has allowed for. */
static int is_within_slack(const fray_world *w) {
  const int32_t most = w->selves->slack;
  for (uint32_t p = 0; p < w->particles; ++p) {
    const vec3 end = w->ways[p].end;
    if (!within(w->x[p], end.x, most) || !within(w->y[p], end.y, most) || !within(w->z[p], end.z, most))
      return 0;
  }
  return 1;
}

static void join_all(fray_world *w) {
  w->state->faults |= (int32_t)FRAY_FAULT_SELVES;
  for (uint32_t p = (uint32_t)w->params->held; p < w->particles; ++p)
    join_two(w, (uint32_t)w->params->held, p);
  move_zones(w);
}

/* Particles that a split has made were where their crossing was. */
static void begin_born(fray_world *w) {
  for (uint32_t p = w->began; p < w->particles; ++p)
    w->ways[p].begin = w->ways[w->crossing[w->place[p]]].begin;
}

void selves_run(fray_world *w) {
  if (!world_has_selves(w)) return;
  begin_born(w);
  for (uint32_t pass = 0; pass < SELVES_PASSES; ++pass) {
    begin_pass(w);
    if (!selves_find(w)) break;
    if (pass == 0) push_pairs(w);
    join_pairs(w);
    if (is_within_slack(w)) return;
  }
  join_all(w);
}
