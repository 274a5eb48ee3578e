/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/model/world.h"

#include "rt/base/random.h"
#include "rt/wide/wide.h"

void world_kill_row(fray_world *w, uint32_t row) {
  if (w->row_class[row] == ROW_DEAD) return;
  w->row_class[row] = ROW_DEAD;
  world_toggle(w, TOPOLOGY_ROW, w->home[row], ROW_DEAD);
}

void world_toggle(fray_world *w, uint32_t field, uint32_t id, uint32_t value) {
  const uint64_t entry = hash_entry(field, id, value);
  w->state->topology[0] ^= (int32_t)(uint32_t)(entry & 0xFFFFFFFFu);
  w->state->topology[1] ^= (int32_t)(uint32_t)(entry >> 32);
}

uint64_t world_topology(const fray_world *w) {
  uint64_t total = 0;
  if (world_has_sheet(w)) return sheet_topology(w);
  for (uint32_t row = 0; row < w->capacity[POOL_ROWS]; ++row)
    if (w->row_class[row] == ROW_DEAD)
      total ^= hash_entry(TOPOLOGY_ROW, w->home[row], ROW_DEAD);
  if (!world_has_yarns(w)) return total;
  for (uint32_t c = 0; c < w->capacity[POOL_CROSSINGS]; ++c) {
    if (w->couple[c] != FRAY_WHOLE) total ^= hash_entry(TOPOLOGY_COUPLE, c, w->couple[c]);
    if (w->warp_at[c] != w->crossing[c]) total ^= hash_entry(TOPOLOGY_WARP, c, w->warp_at[c]);
  }
  return total;
}

/* The two words that hold the hash itself count as zero: words 6 and 7, on the last two lanes. */
static void hash_state(hash *h, const state *s) {
  _Static_assert(offsetof(state, hash) == 4 * (HASH_LANES - 2), "the hash ends a round of lanes");
  const int32_t *words = (const int32_t *)(const void *)s;
  hash_words(h, words, HASH_LANES - 2);
  h->lane[HASH_LANES - 2] = hash_step(h->lane[HASH_LANES - 2], 0);
  h->lane[HASH_LANES - 1] = hash_step(h->lane[HASH_LANES - 1], 0);
  hash_words(h, words + HASH_LANES, STATE_WORDS - HASH_LANES);
}

/* Arrays of particles are hashed on their own, the three axes at a time, and joined: so none waits
 * for another. */
void world_hash_axes(const fray_world *w, world_hashed which, hash axes[3], uint32_t first,
                     uint32_t end) {
  const uint32_t count = end - first;
  const int32_t *const positions[3] = {w->x + first, w->y + first, w->z + first};
  const int32_t *const velocities[3] = {w->vx + first, w->vy + first, w->vz + first};
  const int8_t *const remainders[3] = {w->rx + first, w->ry + first, w->rz + first};
  if (which == HASHED_REMAINDERS) {
    const uint32_t taken = wide_hash_bytes(w->kernel, axes, remainders, count);
    for (uint32_t n = 0; n < 3; ++n) hash_bytes(&axes[n], remainders[n] + taken, count - taken);
  } else {
    const int32_t *const *words = which == HASHED_POSITIONS ? positions : velocities;
    const uint32_t taken = wide_hash_words(w->kernel, axes, words, count);
    for (uint32_t n = 0; n < 3; ++n) hash_words(&axes[n], words[n] + taken, count - taken);
  }
}

static void hash_sheet(hash *h, const fray_world *w) {
  hash_words(h, (const int32_t *)(const void *)w->sheet.state, SHEET_STATE_WORDS);
  hash_words(h, (const int32_t *)(const void *)w->habits,
             (uint32_t)w->sheet.state->triangles * HABIT_WORDS);
}

void world_hash_begin(const fray_world *w, hash *h) {
  hash_begin(h);
  hash_state(h, w->state);
  if (world_has_yarns(w))
    hash_words(h, (const int32_t *)(const void *)w->yarn_state, YARN_STATE_WORDS);
  if (world_has_sheet(w))
    hash_sheet(h, w);
  hash_words(h, (const int32_t *)(const void *)w->body_states,
             w->capacity[POOL_BODIES] * BODY_STATE_WORDS);
}

uint64_t world_hash(const fray_world *w) {
  hash h;
  hash axes[3];
  world_hash_begin(w, &h);
  for (uint32_t which = 0; which < HASHED; ++which) {
    for (uint32_t n = 0; n < 3; ++n) hash_begin(&axes[n]);
    world_hash_axes(w, (world_hashed)which, axes, 0, w->particles);
    for (uint32_t n = 0; n < 3; ++n) hash_join(&h, &axes[n]);
  }
  return hash_end(&h);
}

/* What a row's draws go by; worlds that are not mirrored need no frame for it. */
__attribute__((noinline)) static uint32_t mirrored(const fray_world *w, uint32_t element) {
  return weave_mirror(world_weave(w), element);
}

static inline int32_t drawn(const fray_world *w, uint32_t row, int32_t least, int32_t most) {
  const params *p = w->params;
  uint32_t element = w->home[row];
  if (p->tear_mirrored != 0) element = mirrored(w, element);
  return random_between((uint32_t)p->seed, element, least, most);
}

int32_t world_threshold(const fray_world *w, uint32_t row) {
  return drawn(w, row, w->params->tear_min, w->params->tear_max);
}

int32_t world_transition(const fray_world *w, uint32_t row) {
  return drawn(w, row, w->yarns->transition_min, w->yarns->transition_max);
}
