/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/model/world.h"

#include "rt/base/random.h"
#include "rt/wide/wide.h"

enum { TOPOLOGY_FIELD = 1 };

void world_kill_row(fray_world *w, uint32_t row) {
  if (w->row_class[row] == ROW_DEAD) return;
  w->row_class[row] = ROW_DEAD;
  const uint64_t entry = hash_entry(TOPOLOGY_FIELD, w->home[row], ROW_DEAD);
  w->state->topology[0] ^= (int32_t)(uint32_t)(entry & 0xFFFFFFFFu);
  w->state->topology[1] ^= (int32_t)(uint32_t)(entry >> 32);
}

uint64_t world_topology(const fray_world *w) {
  uint64_t total = 0;
  for (uint32_t row = 0; row < w->capacity[POOL_ROWS]; ++row)
    if (w->row_class[row] == ROW_DEAD)
      total ^= hash_entry(TOPOLOGY_FIELD, w->home[row], ROW_DEAD);
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

static void take_words(fray_kernel kernel, hash *h, const int32_t *words, uint32_t count) {
  const uint32_t taken = wide_hash_words(kernel, h, words, count);
  hash_words(h, words + taken, count - taken);
}

static void take_bytes(fray_kernel kernel, hash *h, const int8_t *bytes, uint32_t count) {
  const uint32_t taken = wide_hash_bytes(kernel, h, bytes, count);
  hash_bytes(h, bytes + taken, count - taken);
}

static void hash_world(const fray_world *w, fray_kernel kernel, hash *h) {
  const uint32_t particles = (uint32_t)w->params->particles;
  const int32_t *const words[6] = {w->x, w->y, w->z, w->vx, w->vy, w->vz};
  const int8_t *const remainders[3] = {w->rx, w->ry, w->rz};
  hash_state(h, w->state);
  for (uint32_t n = 0; n < 6; ++n) take_words(kernel, h, words[n], particles);
  for (uint32_t n = 0; n < 3; ++n) take_bytes(kernel, h, remainders[n], particles);
  hash_words(h, (const int32_t *)(const void *)w->body_states,
             w->capacity[POOL_BODIES] * BODY_STATE_WORDS);
}

uint64_t world_hash(const fray_world *w) {
  hash h;
  hash_begin(&h);
  hash_world(w, w->kernel, &h);
  return hash_end(&h);
}

/* Wide kernels take all lanes. */
void world_hash_lanes(const fray_world *w, uint32_t first, uint32_t end, uint32_t *lanes) {
  hash h;
  hash_begin(&h);
  h.first = first;
  h.end = end;
  hash_world(w, FRAY_KERNEL_SCALAR, &h);
  for (uint32_t n = first; n < end; ++n) lanes[n] = h.lane[n];
}

int32_t world_threshold(const fray_world *w, uint32_t row) {
  uint32_t element = w->home[row];
  if (w->params->tear_mirrored != 0) element = weave_mirror(world_weave(w), element);
  return random_between((uint32_t)w->params->seed, element, w->params->tear_min,
                        w->params->tear_max);
}
