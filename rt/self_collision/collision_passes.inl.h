/* SPDX-License-Identifier: Apache-2.0 */
/* Pushes and merges of one pass of self-collision (after Bridson et al. 2002). Included by
 * yarn_collision.c and triangle_collision.c, which define COLLISION_PAIR, the type of a pair, and before
 * the include
 *
 *   pair_count, pair_at     the pairs that may collide in this tick
 *   pair_particle           particle 0..3 of a pair
 *   pair_push               pushes the two apart, removes their approach, sets `near`; returns 1 iff it
 *                           moved one
 *   pair_touches            1 where they touch on their paths, or may
 *   lead_zones_out          leads zones out of bodies where nothing else does; returns 1 iff it moved one */

/* None of its particles has been moved since its last test. */
static int pair_is_unmoved(const fray_world *w, const COLLISION_PAIR *pair) {
  const uint8_t *moved = w->self.moved_round;
  const uint8_t last = pair->tested_round;
  return moved[pair_particle(w, pair, 0)] < last && moved[pair_particle(w, pair, 1)] < last &&
         moved[pair_particle(w, pair, 2)] < last && moved[pair_particle(w, pair, 3)] < last;
}

static int pair_is_merged(fray_world *w, const COLLISION_PAIR *pair) {
  const uint32_t zone = impact_zones_of(w, pair_particle(w, pair, 0));
  return impact_zones_of(w, pair_particle(w, pair, 1)) == zone &&
         impact_zones_of(w, pair_particle(w, pair, 2)) == zone &&
         impact_zones_of(w, pair_particle(w, pair, 3)) == zone;
}

static void pair_merge(fray_world *w, const COLLISION_PAIR *pair) {
  for (uint32_t k = 1; k < 4; ++k) impact_zones_join(w, pair_particle(w, pair, 0), pair_particle(w, pair, k));
  FRAY_ASSERT(pair_is_merged(w, pair));
}

/* Returns 1 iff something was moved. */
static int push_pairs(fray_world *w) {
  int pushed = 1;
  int moved = 0;
  for (uint32_t round = 0; round < SELF_ROUNDS && pushed; ++round) {
    pushed = 0;
    ++w->self.round;
    for (uint32_t n = 0; n < pair_count(w); ++n) {
      COLLISION_PAIR *pair = pair_at(w, n);
      if (pair_is_unmoved(w, pair)) continue;
      pair->tested_round = w->self.round;
      pushed |= pair_push(w, pair);
    }
    pushed |= lead_zones_out(w);
    moved |= pushed;
  }
  return moved;
}

/* Returns 1 iff two were merged. */
static int merge_touching(fray_world *w) {
  int merged = 0;
  ++w->self.round;
  for (uint32_t n = 0; n < pair_count(w); ++n) {
    COLLISION_PAIR *pair = pair_at(w, n);
    if (pair_is_merged(w, pair) || (pair_is_unmoved(w, pair) && !pair->near)) continue;
    pair->tested_round = w->self.round;
    pair->near = (uint8_t)pair_touches(w, pair);
    if (!pair->near) continue;
    pair_merge(w, pair);
    merged = 1;
  }
  return merged;
}

static void move_zones(fray_world *w) {
  impact_zones_move(w);
  (void)lead_zones_out(w);
}

/* Merges what touches until nothing does; where that takes too many rounds, all that is near something. */
static void merge_pairs(fray_world *w) {
  FRAY_ASSERT(w->self.round + (uint32_t)SELF_MERGES <= UINT8_MAX);
  move_zones(w);
  for (uint32_t round = 0; round < SELF_MERGES; ++round) {
    if (!merge_touching(w)) return;
    move_zones(w);
  }
  for (uint32_t n = 0; n < pair_count(w); ++n) {
    pair_merge(w, pair_at(w, n));
    impact_zones_join(w, pair_particle(w, pair_at(w, 0), 0), pair_particle(w, pair_at(w, n), 0));
  }
  move_zones(w);
}
