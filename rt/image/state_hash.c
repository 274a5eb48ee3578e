/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/image/state_hash.h"

#include "rt/simd/simd.h"

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
void state_hash_axes(const fray_world *w, state_hash_part which, hash axes[3], uint32_t first,
                     uint32_t end) {
  FRAY_ASSERT(first <= end && end <= w->p.count && first % HASH_LANES == 0);
  FRAY_ASSERT((uint32_t)which < HASHED);
  const uint32_t count = end - first;
  const int32_t *const positions[3] = {w->p.x + first, w->p.y + first, w->p.z + first};
  const int32_t *const velocities[3] = {w->p.vx + first, w->p.vy + first, w->p.vz + first};
  const int8_t *const remainders[3] = {w->p.rx + first, w->p.ry + first, w->p.rz + first};
  if (which == HASHED_REMAINDERS) {
    const uint32_t taken = simd_hash_bytes(w->kernel, axes, remainders, count);
    for (uint32_t n = 0; n < 3; ++n) hash_bytes(&axes[n], remainders[n] + taken, count - taken);
  } else {
    const int32_t *const *words = which == HASHED_POSITIONS ? positions : velocities;
    const uint32_t taken = simd_hash_words(w->kernel, axes, words, count);
    for (uint32_t n = 0; n < 3; ++n) hash_words(&axes[n], words[n] + taken, count - taken);
  }
}

static void hash_sheet(hash *h, const fray_world *w) {
  hash_words(h, (const int32_t *)(const void *)w->trimesh.state, TRIMESH_STATE_WORDS);
  hash_words(h, (const int32_t *)(const void *)w->membrane.stiffness,
             triangles_in_use(w) * STIFFNESS_STATE_WORDS);
  hash_words(h, (const int32_t *)(const void *)w->membrane.bend_states,
             triangles_in_use(w) * BEND_STATE_WORDS);
#if FRAY_CRACKS
  if (world_has_cracks(w))
    hash_words(h, (const int32_t *)(const void *)w->membrane.cracks, CRACK_STATE_WORDS);
#endif
}

void state_hash_begin(const fray_world *w, hash *h) {
  hash_begin(h);
  hash_state(h, w->state);
  if (world_has_yarns(w)) {
    hash_words(h, (const int32_t *)(const void *)w->woven.yarn_counts, YARN_STATE_WORDS);
    hash_words(h, (const int32_t *)(const void *)w->woven.contacts,
               (uint32_t)w->woven.yarn_counts->split * YARN_CONTACT_WORDS);
  }
  if (world_has_membrane(w))
    hash_sheet(h, w);
  hash_words(h, (const int32_t *)(const void *)w->rigid.states,
             w->capacity[POOL_BODIES] * BODY_STATE_WORDS);
#if FRAY_HANDLES
  if (world_has_handles(w))
    hash_words(h, (const int32_t *)(const void *)w->handles.states, FRAY_HANDS * HANDLE_STATE_WORDS);
#endif
}

uint64_t state_hash(const fray_world *w) {
  hash h;
  hash axes[3];
  state_hash_begin(w, &h);
  for (uint32_t which = 0; which < HASHED; ++which) {
    for (uint32_t n = 0; n < 3; ++n) hash_begin(&axes[n]);
    state_hash_axes(w, (state_hash_part)which, axes, 0, w->p.count);
    for (uint32_t n = 0; n < 3; ++n) hash_join(&h, &axes[n]);
  }
  return hash_end(&h);
}
