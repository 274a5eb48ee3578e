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
#include "rt/stage/zones.h"

void selves_begin(fray_world *w) {
  if (!world_has_selves(w)) return;
  for (uint32_t p = 0; p < w->particles; ++p) w->ways[p].begin = world_position(w, p);
  w->began = w->particles;
}

void selves_join(fray_world *w, const self_pair *pair) {
  zones_join(w, w->row_i[pair->a], w->row_j[pair->a]);
  zones_join(w, w->row_i[pair->b], w->row_j[pair->b]);
  zones_join(w, w->row_i[pair->a], w->row_i[pair->b]);
}

static int is_joined(fray_world *w, const self_pair *pair) {
  const uint32_t zone = zones_of(w, w->row_i[pair->a]);
  return zones_of(w, w->row_j[pair->a]) == zone && zones_of(w, w->row_i[pair->b]) == zone &&
         zones_of(w, w->row_j[pair->b]) == zone;
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
  zones_move(w);
  for (uint32_t round = 0; round < SELVES_MERGES; ++round) {
    if (!join_touching(w)) return;
    zones_move(w);
  }
  for (uint32_t n = 0; n < w->pair_count; ++n) {
    selves_join(w, &w->pairs[n]);
    zones_join(w, w->row_i[w->pairs[0].a], w->row_i[w->pairs[n].a]);
  }
  zones_move(w);
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
    zones_begin(w);
    if (!selves_find(w)) break;
    if (pass == 0) push_pairs(w);
    join_pairs(w);
    if (zones_stay(w)) return;
  }
  zones_join_all(w);
}
